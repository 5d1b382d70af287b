#include "viewer/data/describe_files.h"

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/gis/read_maps.h"

namespace skyquilt::viewer::opening {
namespace {

using Json = nlohmann::json;

bool IsTileName(const std::string& name) {
  if (name.size() < 5 || name.size() > 60 || !name.ends_with(".glb")) return false;
  return std::all_of(name.begin(), name.end() - 4, [](unsigned char c) { return std::isdigit(c) != 0 || c == '_' || c == '-'; });
}

// Names of the files of a finished set of tiles.
std::set<std::string> ListTiles(const std::filesystem::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  const auto is_plain_file = [&error](const std::filesystem::path& file) {
    return std::filesystem::symlink_status(file, error).type() == std::filesystem::file_type::regular;
  };
  if (!is_plain_file(folder / "tileset.json")) return names;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string name = entry->path().filename().string();
    if (IsTileName(name) && is_plain_file(entry->path())) names.insert(std::move(name));
  }
  if (!names.empty()) names.insert("tileset.json");
  return names;
}

}  // namespace

// surface.json is written last, so that it vouches for all files of a surface.
void DescribeSurface(OpenedProject* opened) {
  Json& json = opened->description;
  json["surface"] = json["tiles"] = json["contours"] = nullptr;
  const std::filesystem::path folder = opened->project.SurfaceFolder();
  const JsonFile table = ReadJson(opened->project.SurfaceTable());
  const bool finished = table.json.is_object();
  std::string advice = Command(*opened, "surface");
  std::string reason = "there is no textured surface yet";
  if (finished) {
    const auto number = [&](const char* key) {
      const double value = base::NumberIn(table.json, key);
      return value > 0.0 && value < 1e15 ? value : 0.0;
    };
    json["surface"] = {{"triangles", static_cast<int64_t>(number("triangles"))},
                       {"points", static_cast<int64_t>(number("points"))},
                       {"area_m2", number("area_m2")},
                       {"voxel_m", number("voxel_m")}};
    opened->tiles = ListTiles(folder / "tiles");
    opened->contours = Exists(folder / "contours.gpkg");
    if (!opened->tiles.empty()) json["tiles"] = "tiles/tileset.json";
    if (opened->contours) json["contours"] = "contours.json";
    const bool none = base::NumberIn(table.json, "triangles") == 0.0;
    reason = none ? "no surface was found in the scene: see the log of 'skyquilt surface'" : "the surface was made without tiles (surface.tiles)";
    if (!none) advice = Command(*opened, "surface --restart --set surface.tiles=true");
  } else if (table.damaged) {
    reason = "surface.json is damaged";
    advice += kRestart;
  } else if (IsUnfinished(*opened, "surface") || Exists(folder)) {
    reason = "the surface is still being made, or was interrupted";
    advice = "Wait for it, or go on with `" + advice + "`";
  }
  if (opened->tiles.empty()) AddMissing(opened, "textured surface", reason, advice);
  if (!opened->contours) {
    AddMissing(opened, "contours", finished ? "the surface was made without maps (surface.maps)" : "they are made together with the surface",
               finished ? Command(*opened, "surface --restart --set surface.maps=true") : advice);
  }
}

// Surface model and orthophoto, which are shown where there is no surface.
void DescribeMaps(OpenedProject* opened) {
  Json& json = opened->description;
  json["terrain"] = json["orthophoto"] = nullptr;
  const std::filesystem::path dsm = opened->project.ProductsFolder() / "dsm.tif";
  if (!Exists(dsm)) {
    if (opened->tiles.empty()) AddMissing(opened, "surface model", "there is no orthophoto and no surface model yet", Command(*opened, "render"));
    return;
  }
  try {
    SurveyFrame(opened->origin, opened->georeferenced).RequireFits(gis::ReadMapGrid(dsm).georeferenced, dsm);
    opened->terrain = true;
    json["terrain"] = "terrain.bin";
  } catch (const base::InputError& error) {
    AddMissing(opened, "surface model", error.what(), Command(*opened, "render") + kRestart);
    return;
  }
  opened->orthophoto = Exists(opened->project.ProductsFolder() / "orthophoto.tif");
  if (opened->orthophoto) {
    json["orthophoto"] = "orthophoto.jpg";
  } else {
    AddMissing(opened, "orthophoto", "there is no products/orthophoto.tif", Command(*opened, "render"));
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
                      {"psnr_db", NullIfUnknown(base::NumberIn(per_block, block.name))}});
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
    const bool has_root = Exists(survey.photo_root);
    for (const survey::Photo& photo : survey.photos) {
      const std::filesystem::path file = PhotoFile(survey, photo);
      std::error_code error;
      const bool available = has_root && !file.empty() && std::filesystem::is_regular_file(file, error);
      if (!available) ++gone;
      const Eigen::Quaterniond& q = photo.cam_from_enu.rotation;
      photos.push_back({{"name", photo.name},
                        {"camera", photo.camera},
                        {"position", ListOf(photo.cam_from_enu.OriginInSource())},
                        {"rotation", {q.w(), q.x(), q.y(), q.z()}},
                        {"is_test", photo.is_test},
                        {"psnr_db", NullIfUnknown(base::NumberIn(per_photo, photo.name))},
                        {"available", available}});
    }
    if (gone > 0) {
      AddMissing(
          opened, "pictures of photos",
          std::to_string(gone) + " of " + std::to_string(survey.photos.size()) + " photos are not in " + survey.photo_root.string() + " any more",
          "Put them back there, or connect the disk on which they are");
    }
  }
  opened->description["cameras"] = std::move(cameras);
  opened->description["photos"] = std::move(photos);
  const bool points = opened->survey != nullptr && !opened->survey->points.empty();
  opened->description["points"] = points ? Json("points.bin") : Json(nullptr);
}

void DescribeMetrics(OpenedProject* opened, const JsonFile& file) {
  const Json& metrics = file.json;
  opened->description["metrics"] = nullptr;
  if (!metrics.is_object()) {
    AddMissing(opened, "scores", file.damaged ? "report/metrics.json is damaged" : "the held-out photos are not scored yet",
               Command(*opened, "evaluate") + (file.damaged ? kRestart : ""));
    return;
  }
  Json kept = Json::object();
  for (const char* key : {"psnr", "ssim", "flip", "lpips", "coverage", "psnr_full_frame", "depth_rmse_m", "depth_median_abs_m", "seam_psnr_gap_db"}) {
    kept[key] = NullIfUnknown(base::NumberIn(metrics, key));
  }
  if (metrics.contains("surface")) kept["surface_psnr"] = NullIfUnknown(base::NumberIn(metrics["surface"], "psnr"));
  opened->description["metrics"] = std::move(kept);
}

}  // namespace skyquilt::viewer::opening
