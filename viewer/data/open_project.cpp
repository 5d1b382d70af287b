#include "viewer/data/open_project.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/scene/field_store.h"
#include "core/scene/scene_file.h"
#include "partition/block.h"
#include "surface/map_frame.h"
#include "viewer/data/describe_buildings.h"
#include "viewer/data/describe_files.h"
#include "viewer/data/opening.h"

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

// What scene.h5 says of itself, without its fields.
struct SceneFacts {
  geo::Geodetic origin;
  bool georeferenced = false;
  geo::PlaceAccuracy accuracy;
  geo::HeightReference height_reference = geo::HeightReference::kUnknown;
  double gsd_m = 0.0;
  std::vector<geo::BlockBox> boxes;
  int64_t parameters = 0;
};

std::optional<partition::BlockSet> ReadBlocks(OpenedProject* opened) {
  if (!opening::Exists(opened->project.BlocksFile())) {
    opening::AddMissing(opened, "blocks", "the area is not divided into blocks yet", opening::Command(*opened, "partition"));
    return {};
  }
  try {
    return partition::LoadBlocks(opened->project.BlocksFile());
  } catch (const base::InputError& error) {
    opening::AddMissing(opened, "blocks", error.what(), opening::Command(*opened, "partition") + opening::kRestart);
    return {};
  }
}

void ReadSurvey(OpenedProject* opened, const OpenedProject* earlier) {
  opened->survey_state = LookAt(opened->project.SurveyFolder() / "survey.json");
  if (earlier != nullptr && earlier->survey != nullptr && earlier->survey_state == opened->survey_state) {
    opened->survey = earlier->survey;
  } else {
    try {
      opened->survey = std::make_shared<const survey::Survey>(survey::LoadSurvey(opened->project.SurveyFolder()));
    } catch (const base::InputError& error) {
      opening::AddMissing(opened, "photos and sparse points", error.what(),
                          opening::Command(*opened, "prepare PHOTOS -o") + (opened->survey_state.exists ? opening::kRestart : ""));
      return;
    }
  }
  opened->origin = opened->survey->origin;
  opened->georeferenced = opened->survey->georeferenced;
}

std::optional<SceneFacts> ReadScene(OpenedProject* opened) {
  const std::filesystem::path file = opened->project.SceneFile();
  if (!opening::Exists(file)) {
    if (opening::Exists(opened->project.TrainReport())) {
      opening::AddMissing(opened, "exact frames", "the trained blocks are not merged yet", opening::Command(*opened, "merge"));
    } else if (opening::IsUnfinished(*opened, "train")) {
      opening::AddMissing(
          opened, "exact frames", "the scene is still being trained, or its training was interrupted",
          "Wait for it, or go on with `" + opening::Command(*opened, "train") + "` and then `" + opening::Command(*opened, "merge") + "`");
    } else {
      opening::AddMissing(opened, "exact frames", "the scene is not trained yet",
                          opening::Command(*opened, "train") + "\n" + opening::Command(*opened, "merge"));
    }
    return {};
  }
  try {
    checkpoint::ArchiveReader reader = scene::OpenScene(file);
    SceneFacts facts;
    facts.origin = {reader.DoubleAttribute("origin_latitude_deg"), reader.DoubleAttribute("origin_longitude_deg"),
                    reader.DoubleAttribute("origin_height_m")};
    facts.georeferenced = reader.IntAttribute("georeferenced") != 0;
    facts.accuracy = scene::GetAccuracy(reader);
    facts.height_reference = scene::GetHeightReference(reader, file);
    facts.gsd_m = reader.DoubleAttribute("gsd_m");
    const scene::FieldStore store(std::move(reader), file, 1.0, false);
    for (int k = 0; k < store.size(); ++k) {
      facts.boxes.push_back(store.block(k).box);
      facts.parameters += store.Parameters(k);
    }
    if (store.HasContext()) facts.parameters += store.ContextParameters();
    return facts;
  } catch (const base::InputError& error) {
    opening::AddMissing(opened, "exact frames", std::string("the scene cannot be used: ") + error.what(),
                        opening::Command(*opened, "merge") + opening::kRestart);
    return {};
  }
}

Json AccuracyJson(const geo::PlaceAccuracy& accuracy) {
  return {{"scale_percent", opening::NullIfUnknown(accuracy.scale_percent)},
          {"tilt_deg", opening::NullIfUnknown(accuracy.tilt_deg)},
          {"yaw_deg", opening::NullIfUnknown(accuracy.yaw_deg)},
          {"horizontal_m", opening::NullIfUnknown(accuracy.horizontal_m)},
          {"vertical_m", opening::NullIfUnknown(accuracy.vertical_m)}};
}

// Without a survey, the scene or the blocks know the place.
void DescribePlace(OpenedProject* opened, const std::optional<SceneFacts>& scene, const std::optional<partition::BlockSet>& blocks) {
  Json& json = opened->description;
  scene::SceneInfo info;
  info.min_enu = info.max_enu = Eigen::Vector3d::Zero();
  if (opened->survey != nullptr) {
    info.accuracy = opened->survey->fit.accuracy;
    info.height_reference = opened->survey->height_reference;
  } else if (scene) {
    opened->origin = scene->origin;
    opened->georeferenced = scene->georeferenced;
    info.accuracy = scene->accuracy;
    info.height_reference = scene->height_reference;
  } else if (blocks) {
    opened->origin = blocks->origin;
    opened->georeferenced = blocks->georeferenced;
    info.accuracy = blocks->accuracy;
    info.height_reference = blocks->height_reference;
  }
  info.origin = opened->origin;
  info.georeferenced = opened->georeferenced && geo::IsValid(opened->origin);
  json["georeferenced"] = opened->georeferenced = info.georeferenced;
  json["origin"] = {{"latitude_deg", info.georeferenced ? info.origin.latitude_deg : 0.0},
                    {"longitude_deg", info.georeferenced ? info.origin.longitude_deg : 0.0},
                    {"height_m", info.georeferenced ? info.origin.height_m : 0.0}};
  const surface::MapFrame frame(info);
  opened->zone = frame.zone();
  json["crs"] = info.georeferenced ? Json{{"name", frame.CrsName()}, {"zone", frame.zone().zone}, {"north", frame.zone().north}} : Json(nullptr);
  json["vertical"] = frame.VerticalName();
  json["accuracy"] = AccuracyJson(info.accuracy);
}

void Extend(const geo::BlockBox& box, Eigen::AlignedBox3d* all) {
  all->extend(box.min_enu);
  all->extend(box.max_enu);
}

// Box of the scene: of its blocks, else of what most sparse points show, else of the cameras.
void DescribeBox(OpenedProject* opened, const std::optional<SceneFacts>& scene, const std::optional<partition::BlockSet>& blocks) {
  Json& json = opened->description;
  Eigen::AlignedBox3d box;
  double gsd = std::numeric_limits<double>::infinity();
  if (scene) {
    for (const geo::BlockBox& block : scene->boxes) Extend(block, &box);
    if (scene->gsd_m > 0.0) gsd = scene->gsd_m;
  }
  if (blocks) {
    const bool from_blocks = box.isEmpty();
    for (const partition::Block& block : blocks->blocks) {
      if (block.empty) continue;
      if (from_blocks) Extend(block, &box);
      if (block.gsd_m > 0.0 && !(scene && scene->gsd_m > 0.0)) gsd = std::min(gsd, block.gsd_m);
    }
  }
  std::array<std::vector<double>, 3> places;
  if (opened->survey != nullptr) {
    const auto add = [&places](const Eigen::Vector3d& x) {
      for (size_t i = 0; i < 3; ++i) places[i].push_back(x(static_cast<int>(i)));
    };
    for (const survey::SparsePoint& point : opened->survey->points) add(point.x_in_enu);
    if (places[0].empty()) {
      for (const survey::Photo& photo : opened->survey->photos) add(photo.cam_from_enu.OriginInSource());
    }
  }
  if (box.isEmpty() && !places[0].empty()) {
    Eigen::Vector3d low, high;
    for (size_t i = 0; i < 3; ++i) {
      low(static_cast<int>(i)) = base::NearestRankQuantile(places[i], 0.02);
      high(static_cast<int>(i)) = base::NearestRankQuantile(places[i], 0.98);
    }
    box = Eigen::AlignedBox3d(low, high);
  }
  if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) {
    box = Eigen::AlignedBox3d(Eigen::Vector3d::Constant(-50.0), Eigen::Vector3d::Constant(50.0));
  }
  json["min_enu"] = opening::ListOf(box.min());
  json["max_enu"] = opening::ListOf(box.max());
  json["ground_m"] = places[2].empty() ? box.min().z() : std::clamp(base::NearestRankQuantile(places[2], 0.3), box.min().z(), box.max().z());
  json["gsd_m"] = opening::NullIfUnknown(gsd);
}

}  // namespace

OpenedProject OpenProject(const coordinator::Project& project, const OpenedProject* earlier) {
  OpenedProject opened;
  opened.project = project;
  std::filesystem::path folder = project.folder.lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  opened.description = {{"name", folder.filename().string()}, {"missing", Json::array()}};
  ReadSurvey(&opened, earlier);
  const std::optional<SceneFacts> scene = ReadScene(&opened);
  opened.description["scene"] =
      scene ? Json{{"blocks", scene->boxes.size()}, {"parameters", scene->parameters}, {"trust", std::filesystem::exists(project.TrustFile())}}
            : Json(nullptr);
  const std::optional<partition::BlockSet> blocks = ReadBlocks(&opened);
  const opening::JsonFile metrics = opening::ReadJson(project.MetricsFile());
  DescribePlace(&opened, scene, blocks);
  DescribeBox(&opened, scene, blocks);
  opening::DescribeSurface(&opened);
  opening::DescribeMaps(&opened);
  opening::DescribeBuildings(&opened);
  opening::DescribeBlocks(&opened, blocks, metrics.json);
  opening::DescribePhotos(&opened, metrics.json);
  opening::DescribeMetrics(&opened, metrics);
  return opened;
}

std::filesystem::path PhotoFile(const survey::Survey& survey, const survey::Photo& photo) {
  const std::filesystem::path name = std::filesystem::path(photo.name).lexically_normal();
  if (name.empty() || name.is_absolute() || *name.begin() == "..") return {};
  return survey.photo_root / name;
}

nlohmann::json EnuFromOther(const OpenedProject& main, const OpenedProject& other) {
  const std::optional<geo::Rigid3d> main_from_other = OtherFromMain({other.origin, other.georeferenced}, {main.origin, main.georeferenced});
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  if (main_from_other) {
    transform.topLeftCorner<3, 3>() = main_from_other->rotation.toRotationMatrix();
    transform.topRightCorner<3, 1>() = main_from_other->translation;
  }
  Json list = Json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) list.push_back(transform(row, column));
  }
  return list;
}

}  // namespace skyquilt::viewer
