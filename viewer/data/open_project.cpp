#include "viewer/data/open_project.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/ecef.h"
#include "core/scene/scene_file.h"
#include "partition/block.h"
#include "surface/map_frame.h"

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

constexpr const char* kCopyOption = "--restart";

Json NullIfUnknown(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json ListOf(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

void Miss(OpenedProject* opened, const std::string& what, const std::string& reason, const std::string& advice) {
  opened->description["missing"].push_back({{"what", what}, {"reason", reason}, {"advice", advice}});
}

std::string Command(const OpenedProject& opened, const std::string& words) {
  return "skyquilt " + words + " " + opened.project.folder.string();
}

// A JSON file of the project, or null when it is missing or damaged.
Json ReadJson(const std::filesystem::path& file) {
  try {
    Json json = Json::parse(base::ReadFile(file), nullptr, false);
    return json.is_discarded() ? Json(nullptr) : json;
  } catch (const base::InputError&) {
    return nullptr;
  }
}

double NumberIn(const Json& json, const char* key) {
  if (!json.is_object()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = json.find(key);
  return at != json.end() && at->is_number() ? at->get<double>() : std::numeric_limits<double>::quiet_NaN();
}

std::optional<partition::BlockSet> ReadBlocks(OpenedProject* opened) {
  if (!std::filesystem::exists(opened->project.BlocksFile())) {
    Miss(opened, "blocks", "the area is not divided into blocks yet", Command(*opened, "partition"));
    return {};
  }
  try {
    return partition::LoadBlocks(opened->project.BlocksFile());
  } catch (const base::InputError& error) {
    Miss(opened, "blocks", error.what(), Command(*opened, "partition") + " " + kCopyOption);
    return {};
  }
}

void ReadSurvey(OpenedProject* opened) {
  try {
    auto survey = std::make_shared<survey::Survey>(survey::LoadSurvey(opened->project.SurveyFolder()));
    opened->origin = survey->origin;
    opened->georeferenced = survey->georeferenced;
    opened->survey = std::move(survey);
  } catch (const base::InputError& error) {
    Miss(opened, "photos and sparse points", error.what(), "skyquilt prepare PHOTOS -o " + opened->project.folder.string() + " " + kCopyOption);
  }
}

// Scene's attributes; the place of the project when there is no survey.
void DescribeScene(OpenedProject* opened) {
  Json& json = opened->description;
  json["scene"] = nullptr;
  const std::filesystem::path file = opened->project.SceneFile();
  if (!std::filesystem::exists(file)) {
    const bool trained = std::filesystem::exists(opened->project.TrainReport());
    Miss(opened, "exact frames", trained ? "the trained blocks are not merged yet" : "the scene is not trained yet",
         Command(*opened, trained ? "merge" : "train"));
    return;
  }
  try {
    const checkpoint::ArchiveReader reader = scene::OpenScene(file);
    const int64_t blocks = reader.IntAttribute("blocks");
    const Json training = ReadJson(opened->project.TrainReport());
    const double parameters = NumberIn(training, "parameters");
    json["scene"] = {{"blocks", blocks}, {"parameters", std::isfinite(parameters) ? static_cast<int64_t>(parameters) : 0}};
    json["gsd_m"] = NullIfUnknown(reader.DoubleAttribute("gsd_m"));
    if (opened->survey == nullptr) {
      opened->origin = {reader.DoubleAttribute("origin_latitude_deg"), reader.DoubleAttribute("origin_longitude_deg"),
                        reader.DoubleAttribute("origin_height_m")};
      opened->georeferenced = reader.IntAttribute("georeferenced") != 0;
    }
  } catch (const base::InputError& error) {
    Miss(opened, "exact frames", std::string("the scene cannot be used: ") + error.what(), Command(*opened, "merge") + " " + kCopyOption);
  }
}

Json AccuracyJson(const geo::PlaceAccuracy& accuracy) {
  return {{"scale_percent", NullIfUnknown(accuracy.scale_percent)},
          {"tilt_deg", NullIfUnknown(accuracy.tilt_deg)},
          {"yaw_deg", NullIfUnknown(accuracy.yaw_deg)},
          {"horizontal_m", NullIfUnknown(accuracy.horizontal_m)},
          {"vertical_m", NullIfUnknown(accuracy.vertical_m)}};
}

void DescribePlace(OpenedProject* opened) {
  Json& json = opened->description;
  scene::SceneInfo info;
  info.origin = opened->origin;
  info.georeferenced = opened->georeferenced && geo::IsValid(opened->origin);
  if (opened->survey != nullptr) info.accuracy = opened->survey->fit.accuracy;
  json["georeferenced"] = opened->georeferenced = info.georeferenced;
  json["origin"] = {{"latitude_deg", info.georeferenced ? info.origin.latitude_deg : 0.0},
                    {"longitude_deg", info.georeferenced ? info.origin.longitude_deg : 0.0},
                    {"height_m", info.georeferenced ? info.origin.height_m : 0.0}};
  const surface::MapFrame frame(info);
  json["crs"] = info.georeferenced ? Json{{"name", frame.CrsName()}, {"zone", frame.zone().zone}, {"north", frame.zone().north}} : Json(nullptr);
  json["vertical"] = frame.VerticalName();
  json["accuracy"] = AccuracyJson(info.accuracy);
}

double Quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The box of the scene, from blocks, else from what most sparse points show, else from the cameras.
void DescribeBox(OpenedProject* opened, const std::optional<partition::BlockSet>& blocks) {
  Json& json = opened->description;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  double gsd = std::numeric_limits<double>::infinity();
  if (blocks) {
    for (const partition::Block& block : blocks->blocks) {
      if (block.empty) continue;
      low = low.cwiseMin(block.min_enu);
      high = high.cwiseMax(block.max_enu);
      if (block.gsd_m > 0.0) gsd = std::min(gsd, block.gsd_m);
    }
  }
  std::vector<double> axis[3];
  if (opened->survey != nullptr) {
    for (const survey::SparsePoint& point : opened->survey->points) {
      for (int i = 0; i < 3; ++i) axis[i].push_back(point.x_in_enu(i));
    }
    if (axis[0].empty()) {
      for (const survey::Photo& photo : opened->survey->photos) {
        for (int i = 0; i < 3; ++i) axis[i].push_back(photo.cam_from_enu.OriginInSource()(i));
      }
    }
  }
  if (!(low.x() <= high.x()) && !axis[0].empty()) {
    for (int i = 0; i < 3; ++i) {
      low(i) = Quantile(axis[i], 0.02);
      high(i) = Quantile(axis[i], 0.98);
    }
  }
  if (!low.allFinite() || !high.allFinite()) {
    low = Eigen::Vector3d::Constant(-50.0);
    high = Eigen::Vector3d::Constant(50.0);
  }
  json["min_enu"] = ListOf(low);
  json["max_enu"] = ListOf(high);
  json["ground_m"] = axis[2].empty() ? low.z() : std::clamp(Quantile(axis[2], 0.3), low.z(), high.z());
  if (!json.contains("gsd_m") || json["gsd_m"].is_null()) json["gsd_m"] = NullIfUnknown(gsd);
}

bool IsTileName(const std::string& name) {
  if (name.size() < 5 || name.size() > 60 || !name.ends_with(".glb")) return false;
  return std::all_of(name.begin(), name.end() - 4, [](unsigned char c) { return std::isdigit(c) != 0 || c == '_' || c == '-'; });
}

void DescribeSurface(OpenedProject* opened) {
  Json& json = opened->description;
  json["surface"] = json["tiles"] = json["terrain"] = json["orthophoto"] = json["contours"] = nullptr;
  const std::filesystem::path folder = opened->project.SurfaceFolder();
  const Json table = ReadJson(opened->project.SurfaceTable());
  if (table.is_object()) {
    const auto count = [&](const char* key) {
      const double value = NumberIn(table, key);
      return std::isfinite(value) && value > 0.0 ? static_cast<int64_t>(value) : 0;
    };
    const auto size = [&](const char* key) {
      const double value = NumberIn(table, key);
      return std::isfinite(value) && value > 0.0 ? value : 0.0;
    };
    json["surface"] = {{"triangles", count("triangles")}, {"points", count("points")}, {"area_m2", size("area_m2")}, {"voxel_m", size("voxel_m")}};
    std::error_code error;
    if (std::filesystem::exists(folder / "tiles" / "tileset.json", error)) {
      for (const auto& entry : std::filesystem::directory_iterator(folder / "tiles", error)) {
        const std::string name = entry.path().filename().string();
        if (IsTileName(name) && entry.is_regular_file(error)) opened->tiles.insert(name);
      }
    }
    if (!opened->tiles.empty()) {
      opened->tiles.insert("tileset.json");
      json["tiles"] = "tiles/tileset.json";
    }
    opened->contours = std::filesystem::exists(folder / "contours.gpkg", error);
    if (opened->contours) json["contours"] = "contours.json";
  }
  const bool begun = !table.is_object() && std::filesystem::exists(folder);
  if (opened->tiles.empty()) {
    const std::string reason = table.is_object() ? "the surface was made without tiles (surface.tiles)"
                               : begun           ? "the surface is not finished"
                                                 : "there is no textured surface yet";
    Miss(opened, "textured surface", reason,
         table.is_object() ? Command(*opened, "surface") + " --restart --set surface.tiles=true" : Command(*opened, "surface"));
  }
  if (!opened->contours) {
    Miss(opened, "contours", table.is_object() ? "the surface was made without maps (surface.maps)" : "they are made together with the surface",
         Command(*opened, "surface"));
  }
  opened->terrain = std::filesystem::exists(opened->project.ProductsFolder() / "dsm.tif");
  opened->orthophoto = std::filesystem::exists(opened->project.ProductsFolder() / "orthophoto.tif");
  if (opened->terrain) json["terrain"] = "terrain.bin";
  if (opened->orthophoto) json["orthophoto"] = "orthophoto.jpg";
  if (opened->tiles.empty() && !opened->terrain) {
    Miss(opened, "surface model", "there is no orthophoto and no surface model yet", Command(*opened, "render"));
  }
}

void DescribeBlocks(OpenedProject* opened, const std::optional<partition::BlockSet>& blocks, const Json& metrics) {
  Json list = Json::array();
  const Json per_block = metrics.is_object() && metrics.contains("psnr_per_block") ? metrics["psnr_per_block"] : Json(nullptr);
  if (blocks) {
    for (const partition::Block& block : blocks->blocks) {
      list.push_back({{"name", block.name},
                      {"min_enu", ListOf(block.min_enu)},
                      {"max_enu", ListOf(block.max_enu)},
                      {"empty", block.empty},
                      {"photos", block.photos.size()},
                      {"psnr_db", NullIfUnknown(NumberIn(per_block, block.name.c_str()))}});
    }
  }
  opened->description["blocks"] = std::move(list);
}

void DescribePhotos(OpenedProject* opened, const Json& metrics) {
  Json cameras = Json::array(), photos = Json::array();
  if (opened->survey != nullptr) {
    const survey::Survey& survey = *opened->survey;
    const Json per_photo = metrics.is_object() && metrics.contains("psnr_per_image") ? metrics["psnr_per_image"] : Json(nullptr);
    for (const camera::Camera& camera : survey.cameras) {
      cameras.push_back({{"model", camera::ModelName(camera.model)}, {"width", camera.width}, {"height", camera.height}, {"params", camera.params}});
    }
    size_t gone = 0;
    for (const survey::Photo& photo : survey.photos) {
      std::error_code error;
      const bool available = std::filesystem::is_regular_file(survey.photo_root / photo.name, error);
      if (!available) ++gone;
      const Eigen::Quaterniond& q = photo.cam_from_enu.rotation;
      photos.push_back({{"name", photo.name},
                        {"camera", photo.camera},
                        {"position", ListOf(photo.cam_from_enu.OriginInSource())},
                        {"rotation", {q.w(), q.x(), q.y(), q.z()}},
                        {"is_test", photo.is_test},
                        {"psnr_db", NullIfUnknown(NumberIn(per_photo, photo.name.c_str()))},
                        {"available", available}});
    }
    if (gone > 0) {
      Miss(opened, "pictures of photos",
           std::to_string(gone) + " of " + std::to_string(survey.photos.size()) + " photos are not in " + survey.photo_root.string() + " any more",
           "Put them back there");
    }
  }
  opened->description["cameras"] = std::move(cameras);
  opened->description["photos"] = std::move(photos);
  const bool points = opened->survey != nullptr && !opened->survey->points.empty();
  opened->description["points"] = points ? Json("points.bin") : Json(nullptr);
}

void DescribeMetrics(OpenedProject* opened, const Json& metrics) {
  opened->description["metrics"] = nullptr;
  if (!metrics.is_object()) {
    Miss(opened, "scores", "the held-out photos are not scored yet", Command(*opened, "evaluate"));
    return;
  }
  Json kept = Json::object();
  for (const char* key : {"psnr", "ssim", "flip", "lpips", "coverage", "psnr_full_frame", "depth_rmse_m", "depth_median_abs_m", "seam_psnr_gap_db"}) {
    kept[key] = NullIfUnknown(NumberIn(metrics, key));
  }
  if (metrics.contains("surface")) kept["surface_psnr"] = NullIfUnknown(NumberIn(metrics["surface"], "psnr"));
  opened->description["metrics"] = std::move(kept);
}

}  // namespace

OpenedProject OpenProject(const coordinator::Project& project) {
  OpenedProject opened;
  opened.project = project;
  opened.description = {{"name", project.folder.filename().string()}, {"missing", Json::array()}};
  ReadSurvey(&opened);
  DescribeScene(&opened);
  const std::optional<partition::BlockSet> blocks = ReadBlocks(&opened);
  if (opened.survey == nullptr && blocks) {
    opened.origin = blocks->origin;
    opened.georeferenced = blocks->georeferenced;
  }
  const Json metrics = ReadJson(project.MetricsFile());
  DescribePlace(&opened);
  DescribeBox(&opened, blocks);
  DescribeSurface(&opened);
  DescribeBlocks(&opened, blocks, metrics);
  DescribePhotos(&opened, metrics);
  DescribeMetrics(&opened, metrics);
  return opened;
}

nlohmann::json EnuFromOther(const OpenedProject& main, const OpenedProject& other) {
  Eigen::Matrix4d transform = Eigen::Matrix4d::Identity();
  if (main.georeferenced && other.georeferenced) {
    const Eigen::Matrix4d ecef_from_main = geo::EcefFromEnu(main.origin), ecef_from_other = geo::EcefFromEnu(other.origin);
    const Eigen::Matrix3d main_from_ecef = ecef_from_main.topLeftCorner<3, 3>().transpose();
    transform.topLeftCorner<3, 3>() = main_from_ecef * ecef_from_other.topLeftCorner<3, 3>();
    // The difference first: it is small, and loses no digits to the Earth's radius.
    transform.topRightCorner<3, 1>() = main_from_ecef * (ecef_from_other.topRightCorner<3, 1>() - ecef_from_main.topRightCorner<3, 1>());
  }
  Json list = Json::array();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) list.push_back(transform(row, column));
  }
  return list;
}

}  // namespace skyquilt::viewer
