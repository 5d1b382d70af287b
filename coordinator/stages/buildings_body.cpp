// The work of stage "buildings", and pictures of facades.
#include <algorithm>

#include "buildings/classes/classify_points.h"
#include "buildings/files/building_files.h"
#include "buildings/make_buildings.h"
#include "buildings/pictures/building_pictures.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/stages/stage_bodies.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/gis/read_maps.h"
#include "core/gis/read_outlines.h"
#include "core/survey/survey.h"
#include "products/ray_caster.h"
#include "surface/files/las_classes.h"
#include "surface/surface_table.h"

namespace skyquilt::coordinator {
namespace {

using buildings::BuildingSet;

std::vector<buildings::GivenOutline> ReadFootprints(const std::string& file, const surface::MapFrame& frame) {
  std::vector<buildings::GivenOutline> outlines;
  if (file.empty()) return outlines;
  for (const gis::Outline& read : gis::ReadOutlines(file, frame.georeferenced(), frame.zone())) {
    buildings::GivenOutline outline;
    outline.id = read.id;
    const auto in_enu = [&frame](const std::vector<Eigen::Vector2d>& ring) {
      std::vector<Eigen::Vector2d> moved;
      moved.reserve(ring.size());
      // Heights hardly change the place on the ground.
      for (const Eigen::Vector2d& point : ring) moved.push_back(frame.EnuFromMap({point.x(), point.y(), frame.origin().height_m}).head<2>());
      return moved;
    };
    for (size_t i = 0; i < read.rings.size(); ++i) {
      if (i == 0) outline.outline.outer = in_enu(read.rings[i]);
      if (i > 0) outline.outline.holes.push_back(in_enu(read.rings[i]));
    }
    outlines.push_back(std::move(outline));
  }
  return outlines;
}

void ClassifyCloud(const Pipeline& pipeline, const surface::MapFrame& frame, const buildings::PointCloud& cloud, const buildings::GroundGrid& ground,
                   const BuildingSet& set, base::ThreadPool& threads) {
  const std::vector<buildings::PointClass> classes = buildings::ClassifyPoints(cloud, ground, set, pipeline.settings.buildings, threads);
  std::vector<Eigen::Vector3d> positions(cloud.points.size());
  std::vector<uint8_t> codes(cloud.points.size());
  for (size_t i = 0; i < codes.size(); ++i) {
    positions[i] = cloud.At(i);
    codes[i] = buildings::LasCode(classes[i]);
  }
  surface::RewriteLasClasses(pipeline.project.SurfaceFolder(), frame, positions, codes);
}

void LogBuildings(const BuildingSet& set, bool georeferenced, const std::filesystem::path& folder) {
  const auto accepted = std::count_if(set.buildings.begin(), set.buildings.end(), [](const buildings::Building& one) { return one.accepted; });
  base::LogInfo("{} building(s), {} of them fit their roof well: {}", set.buildings.size(), accepted, folder.string());
  if (georeferenced && set.scale != 1.0) {
    base::LogWarning(
        "the scale bar makes lengths {} times as long as the geo-reference. Measures are by the scale bar, coordinates by the geo-reference",
        set.scale);
  }
  if (!set.metric && !set.buildings.empty()) {
    base::LogWarning("the survey has no scale, so lengths of buildings have no unit. Give --scale-bar A B LENGTH with two points and their distance");
  }
}

}  // namespace

std::string BuildingsBody(Pipeline& pipeline, const StageStamp& /*stamp*/) {
  const Project& project = pipeline.project;
  const Settings& settings = pipeline.settings;
  SceneSession session(pipeline.comm, project.SceneFile(), settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  const scene::SceneInfo& info = session.scene().info();
  const surface::MapFrame frame(info, geo::VerticalNamed(settings.products.vertical));
  buildings::BuildingsInput input;
  input.options = settings.buildings;
  input.georeferenced = info.georeferenced;
  input.accuracy = info.accuracy;
  input.gsd_m = info.gsd_m;
  input.footprints = ReadFootprints(settings.buildings.footprints, frame);
  BuildingSet set;
  if (surface::ReadTriangles(project.SurfaceTable()) == 0) {
    base::LogWarning("there is no surface, so there are no buildings");
  } else {
    const std::filesystem::path terrain = project.SurfaceFolder() / "dtm.tif";
    if (!std::filesystem::exists(terrain)) {
      throw base::InputError(terrain, "no such file",
                             KindsOf(pipeline).terrain ? "Run 'skyquilt surface' with --restart and --set surface.maps=true"
                                                       : "Run 'skyquilt surface' with --restart and --set products.kinds=all");
    }
    if (gis::ReadUndulations(terrain) != frame.heights().undulations()) {
      throw base::InputError(terrain, "has other heights than products.vertical = \"" + settings.products.vertical + "\" gives",
                             "Run 'skyquilt surface' with it first");
    }
    const buildings::PointCloud cloud = buildings::LoadSurfacePoints(project.SurfaceWorkFolder(), surface::ReadVoxel(project.SurfaceTable()));
    const buildings::GroundGrid ground = buildings::GroundGrid::Read(terrain, frame);
    input.cloud = &cloud;
    input.ground = &ground;
    for (const survey::SparsePoint& point : survey::LoadSurvey(project.SurveyFolder()).points) input.matched.push_back(point.x_in_enu);
    set = buildings::MakeBuildings(input, session.threads());
    if (settings.buildings.classify_cloud) ClassifyCloud(pipeline, frame, cloud, ground, set, session.threads());
  }
  buildings::WriteBuildings(set, frame, settings.buildings, project.BuildingsFolder());
  LogBuildings(set, info.georeferenced, project.BuildingsFolder());
  return StageStamp::kDone;
}

void WriteFacades(Pipeline& pipeline, const std::vector<int>& ids) {
  const Project& project = pipeline.project;
  const BuildingSet set = buildings::LoadBuildings(project.BuildingsFile());
  for (const int id : ids) {
    if (id < 1 || id > static_cast<int>(set.buildings.size())) {
      throw base::UsageError("--facades " + std::to_string(id) + ": there is no such building; the survey has " +
                             std::to_string(set.buildings.size()) + ", see " + (project.BuildingsFolder() / "buildings.csv").string());
    }
  }
  SceneSession session(pipeline.comm, project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet, &pipeline.rendering_s);
  const scene::SceneInfo& info = session.scene().info();
  const surface::MapFrame map(info, geo::VerticalNamed(pipeline.settings.products.vertical));
  const buildings::FileFrame frame(set, map);
  const surface::RayCaster caster =
      products::CasterOf(session.scene(), products::AppearanceOf(pipeline.settings.products.exposure, info), session.threads());
  const std::filesystem::path folder = project.BuildingsFolder() / "facades";
  std::filesystem::create_directories(folder);
  int64_t pictures = 0;
  for (const buildings::Building& building : set.buildings) {
    if (!ids.empty() && std::find(ids.begin(), ids.end(), building.id) == ids.end()) continue;
    const auto files =
        buildings::WriteFacades(building, caster, frame, pipeline.settings.buildings.facade_gsd * info.gsd_m, folder, session.threads());
    pictures += std::count_if(files.begin(), files.end(), [](const std::filesystem::path& file) { return file.extension() == ".png"; });
  }
  base::LogInfo("{} facade picture(s): {}", pictures, folder.string());
}

}  // namespace skyquilt::coordinator
