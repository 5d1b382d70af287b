// Buildings of variants that are not trained.
#include <algorithm>
#include <limits>

#include "bench/study/buildings_parts.h"
#include "bench/study/sparse_cloud.h"
#include "bench/study/true_rays.h"
#include "buildings/files/building_files.h"
#include "buildings/make_buildings.h"
#include "coordinator/scheduler/field_context.h"
#include "core/base/errors.h"
#include "core/config/options.h"
#include "core/scene/scene.h"
#include "evaluate/buildings/buildings_scorer.h"
#include "partition/block.h"
#include "products/map_area.h"
#include "products/map_rays.h"
#include "surface/make_surface.h"

namespace skyquilt::bench {
namespace {

// What a scene of these blocks would say of itself.
scene::SceneInfo InfoOf(const partition::BlockSet& blocks) {
  scene::SceneInfo info;
  info.origin = blocks.origin;
  info.georeferenced = blocks.georeferenced;
  info.accuracy = blocks.accuracy;
  info.min_enu.setConstant(std::numeric_limits<double>::infinity());
  info.max_enu = -info.min_enu;
  info.gsd_m = std::numeric_limits<double>::infinity();
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    info.min_enu = info.min_enu.cwiseMin(block.min_enu);
    info.max_enu = info.max_enu.cwiseMax(block.max_enu);
    info.gsd_m = std::min(info.gsd_m, block.gsd_m);
  }
  return info;
}

// A project with survey and blocks, and what all ways to its buildings need.
struct OpenProject {
  explicit OpenProject(const coordinator::Pipeline& pipeline)
      : project(pipeline.project),
        settings(pipeline.settings),
        threads(pipeline.settings.run.threads),
        survey(survey::LoadSurvey(pipeline.project.SurveyFolder())),
        info(InfoOf(partition::LoadBlocks(pipeline.project.BlocksFile()))) {}

  const coordinator::Project& project;
  const coordinator::Settings& settings;
  base::ThreadPool threads;
  survey::Survey survey;
  scene::SceneInfo info;
};

// gsd_m: with which buildings are sought. cloud: null when there is no surface.
void FindAndScore(OpenProject& open, const buildings::PointCloud* cloud, const buildings::GroundGrid* ground, double gsd_m, VariantResult* result) {
  buildings::BuildingSet set;
  if (cloud != nullptr) {
    buildings::BuildingsInput input{.options = open.settings.buildings,
                                    .cloud = cloud,
                                    .ground = ground,
                                    .footprints = {},
                                    .matched = {},
                                    .georeferenced = open.info.georeferenced,
                                    .accuracy = open.info.accuracy,
                                    .gsd_m = gsd_m};
    for (const survey::SparsePoint& point : open.survey.points) input.matched.push_back(point.x_in_enu);
    set = buildings::MakeBuildings(input, open.threads);
    set.gsd_m = open.info.gsd_m;  // scores are in those of the photos
  }
  std::filesystem::create_directories(open.project.BuildingsFolder());
  buildings::SaveBuildings(set, surface::MapFrame(open.info), open.project.BuildingsFile());
  // Read back, so that the scores are those of what is kept.
  if (const auto compared = evaluate::buildings::LoadBuildingsOf(open.project.folder, open.survey)) {
    result->buildings = evaluate::buildings::ScoreBuildings(*compared, open.threads);
  }
  result->training_photos =
      static_cast<int>(std::count_if(open.survey.photos.begin(), open.survey.photos.end(), [](const auto& photo) { return !photo.is_test; }));
}

// What limits the maps and the surface of a scene also limits this one. Throws base::InputError.
surface::SurfaceInput SurfaceInputOf(OpenProject& open, const TrueRays& rays) {
  const gis::MapGrid grid = products::PlanHeightGrid(open.info, open.settings.products);
  surface::SurfaceInput input;
  input.options = open.settings.surface;
  input.info = &open.info;
  input.survey = &open.survey;
  input.caster = [&rays, &open](std::span<const render::Ray> asked, std::span<render::RayColor> seen) { rays.Cast(asked, seen, open.threads); };
  input.boundary = products::BoundaryOf(grid, open.settings.products);
  input.map_resolution_m = grid.resolution_m;
  input.memory_bytes = open.settings.run.MemoryLimitBytes();
  input.work_key = config::Hash(open.settings.Flat());
  input.work_folder = open.project.SurfaceWorkFolder();
  input.out_folder = open.project.SurfaceFolder();
  return input;
}

}  // namespace

void MeasureFromTruth(coordinator::Pipeline& pipeline, VariantResult* result) {
  OpenProject open(pipeline);
  if (!open.survey.truth || open.survey.truth->surface_ply.empty()) {
    throw base::UsageError("variant 'truth' needs a simulated survey with truth/surface.ply. Simulate it again, or choose other --variants");
  }
  std::filesystem::create_directories(open.project.PixelCacheFile().parent_path());
  const image::PixelCache pixels =
      image::PixelCache::Open(open.project.PixelCacheFile(), coordinator::PixelSources(open.survey), open.settings.run.image_width, open.threads);
  const TrueRays rays(evaluate::surface::ReadTrueSurface(open.survey.truth->surface_ply, open.survey.origin), open.survey, &pixels);
  const surface::SurfaceResult made = surface::MakeSurface(SurfaceInputOf(open, rays), open.threads);
  if (made.triangles == 0) {
    FindAndScore(open, nullptr, nullptr, open.info.gsd_m, result);
    return;
  }
  const buildings::PointCloud cloud = buildings::LoadSurfacePoints(open.project.SurfaceWorkFolder(), made.voxel_m);
  const buildings::GroundGrid ground = buildings::GroundGrid::Read(open.project.SurfaceFolder() / "dtm.tif", surface::MapFrame(open.info));
  FindAndScore(open, &cloud, &ground, open.info.gsd_m, result);
}

void MeasureFromPoints(coordinator::Pipeline& pipeline, VariantResult* result) {
  OpenProject open(pipeline);
  const surface::SurfaceOptions& options = open.settings.surface;
  const buildings::PointCloud cloud = SparseCloud(open.survey, open.threads);
  const buildings::GroundGrid ground = SparseGround(cloud, {.cell_m = options.terrain_cell_m,
                                                            .window_m = options.terrain_window_m,
                                                            .slope = options.terrain_slope,
                                                            .low_m = options.terrain_low_m,
                                                            .high_m = options.terrain_high_m});
  FindAndScore(open, &cloud, &ground, SparseGsd(cloud, open.info.gsd_m), result);
}

}  // namespace skyquilt::bench
