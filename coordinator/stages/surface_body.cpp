// The work of stage "surface".
#include <optional>

#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/field_context.h"
#include "coordinator/stages/product_area.h"
#include "coordinator/stages/stage_bodies.h"
#include "coordinator/stages/surface_edge.h"
#include "core/base/amounts.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/refined_poses.h"
#include "products/map_area.h"
#include "products/map_rays.h"
#include "products/ray_caster.h"
#include "surface/make_surface.h"

namespace skyquilt::coordinator {
namespace {

// Nothing when photos are gone or changed and the surface can do without them.
std::optional<image::PixelCache> PhotosOf(const Pipeline& pipeline, const survey::Survey& survey, base::ThreadPool& threads) {
  const std::filesystem::path file = pipeline.project.PixelCacheFile();
  try {
    std::filesystem::create_directories(file.parent_path());
    return image::PixelCache::Open(file, PixelSources(survey), pipeline.settings.run.image_width, threads);
  } catch (const base::InputError& error) {
    base::LogWarning("the surface is made without photos, so walls and small things come out less exact, and the texture less sharp: {}",
                     error.what());
    return std::nullopt;
  }
}

}  // namespace

std::string SurfaceBody(Pipeline& pipeline, const StageStamp& stamp) {
  const Project& project = pipeline.project;
  const Settings& settings = pipeline.settings;
  // Half of the limit is for the fields.
  RunOptions run = settings.run;
  run.memory_gb = 0.5 * settings.run.MemoryLimitBytes() / 1073741824.0;
  SceneSession session(pipeline.comm, project.SceneFile(), run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  const scene::Scene& scene = session.scene();
  const survey::Survey survey = survey::LoadRefinedSurvey(project.SurveyFolder());
  const gis::MapGrid grid = products::PlanHeightGrid(scene.info(), settings.products);
  surface::SurfaceInput input;
  input.options = settings.surface;
  input.options.maps = settings.surface.maps && KindsOf(pipeline).terrain;
  input.info = &scene.info();
  input.survey = &survey;
  input.caster = products::CasterOf(scene, products::AppearanceOf(settings.products.exposure, scene.info()), session.threads());
  input.depth_caster = products::CasterOf(scene, {.depths_to_opacity = settings.surface.min_opacity}, session.threads());
  input.boundary = products::BoundaryOf(grid, OptionsOfProducts(pipeline));
  if (!input.boundary && settings.surface.edge_photos > 0) {
    input.boundary = SurfaceEdge(scene.background(), scene.info(), grid, settings.surface.edge_photos);
  }
  input.vertical = geo::VerticalNamed(settings.products.vertical);
  input.map_resolution_m = grid.resolution_m;
  input.memory_bytes = settings.run.MemoryLimitBytes();
  const std::unique_ptr<surface::PieceService> pieces = session.PieceServiceForMesh();
  input.pieces = pieces.get();
  input.work_key = stamp.Hash();
  input.work_folder = project.SurfaceWorkFolder();
  input.out_folder = project.SurfaceFolder();
  std::optional<image::PixelCache> photos;
  if (settings.surface.refine || settings.surface.photo_texture) photos = PhotosOf(pipeline, survey, session.threads());
  if (photos) input.photos = &*photos;
  const surface::SurfaceResult result = surface::MakeSurface(input, session.threads());
  pipeline.rendering_s += result.fusing_s;
  base::LogInfo("surface from {} photos and {} virtual views: {} triangles, {} points, {} file(s) in {}: {}", result.photos, result.virtual_views,
                base::FormatCount(static_cast<double>(result.triangles)), base::FormatCount(static_cast<double>(result.points)), result.files.size(),
                base::FormatDuration(result.seconds), project.SurfaceFolder().string());
  return StageStamp::kDone;
}

}  // namespace skyquilt::coordinator
