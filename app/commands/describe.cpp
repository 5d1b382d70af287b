#include "app/commands/describe.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/commands/describe_number.h"
#include "coordinator/project/project.h"
#include "coordinator/project/stamp.h"
#include "coordinator/stages/stage.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/scene/scene_file.h"
#include "partition/block.h"
#include "products/preview_files.h"

namespace skyquilt::app {
namespace {

using Json = nlohmann::ordered_json;

Json DescribeBlocks(const std::filesystem::path& file) {
  const partition::BlockSet set = partition::LoadBlocks(file);
  Json blocks = Json::array();
  for (const partition::Block& block : set.blocks) {
    const Eigen::Vector3d size = block.max_enu - block.min_enu;
    blocks.push_back({{"name", block.name},
                      {"east_m", Round(block.min_enu.x(), 1)},
                      {"north_m", Round(block.min_enu.y(), 1)},
                      {"width_m", Round(size.x(), 1)},
                      {"depth_m", Round(size.y(), 1)},
                      {"height_m", Round(size.z(), 1)},
                      {"altitude_m", Round(block.altitude_agl_m, 1)},
                      {"gsd_m", Round(block.gsd_m, 4)},
                      {"log2_table_size", block.log2_table_size},
                      {"photos", block.photos.size()},
                      {"cost", Round(block.cost, 4)},
                      {"empty", block.empty ? block.empty_reason : ""}});
  }
  Json json = {
      {"what", "blocks"}, {"rows", set.rows}, {"columns", set.columns}, {"image_width", set.image_width}, {"georeferenced", set.georeferenced}};
  if (set.georeferenced) json["origin"] = DescribeOrigin(set.origin);
  json["accuracy"] = DescribeAccuracy(set.accuracy);
  json["blocks"] = blocks;
  return json;
}

Json DescribeProject(const std::filesystem::path& folder) {
  const coordinator::Project project{std::filesystem::absolute(folder).lexically_normal()};
  Json stages = Json::array();
  for (const coordinator::Stage& stage : coordinator::Stages()) {
    const coordinator::Project home = stage.separate_folder == nullptr ? project : stage.separate_folder(project);
    const std::optional<coordinator::StageStamp> stamp = coordinator::LoadStamp(home, stage.name);
    // A stage that not every project has (simulate) is shown only when it was started.
    if (!stamp && stage.separate_folder != nullptr) continue;
    const coordinator::Paths proof = stage.completion_files(home);
    const bool complete = std::all_of(proof.begin(), proof.end(), [](const auto& path) { return std::filesystem::exists(path); });
    std::string state = stamp ? stamp->state : complete ? "done" : "not started";
    // A preview may lie in the folder of the products before they are made.
    if (!stamp && stage.name == "products" && !products::HasOrthophoto(project.ProductsFolder())) state = "not started";
    if (state == "done" && !complete) state = "files missing";
    if (state == "running") state = "unfinished";
    stages.push_back({{"stage", stage.name},
                      {"state", state},
                      {"finished", stamp ? stamp->finished_utc : ""},
                      {"seconds", stamp ? Round(stamp->seconds, 1) : Json(nullptr)}});
  }
  Json json = {{"what", "project"}, {"folder", project.folder.string()}, {"stages", stages}};
  if (std::filesystem::exists(project.SurveyFolder() / "survey.json")) {
    // The stages are worth seeing also when the survey must be prepared again.
    try {
      json["survey"] = DescribePlace(survey::LoadSurvey(project.SurveyFolder()));
    } catch (const base::InputError& error) {
      json["survey"] = {{"unreadable", error.what()}};
    }
  }
  if (std::filesystem::exists(project.SceneFile())) {
    try {
      json["scales"] = DescribeScales(scene::OpenScene(project.SceneFile()));
    } catch (const base::InputError& error) {
      json["scales"] = {{"unreadable", error.what()}};
    }
  }
  if (products::HasOrthophoto(project.ProductsFolder())) {
    json["orthophoto"] = (project.ProductsFolder() / "orthophoto.tif").string();
  } else {
    for (const products::FoundPreview& preview : products::FindPreviews(project.ProductsFolder())) {
      json["previews"].push_back({{"picture", preview.picture.string()}, {"made_from", preview.made_from}});
    }
  }
  const std::filesystem::path metrics = project.ReportFolder() / "metrics.json";
  if (std::filesystem::exists(metrics)) {
    const Json all = Json::parse(base::ReadFile(metrics), nullptr, false);
    for (const char* key : {"psnr", "ssim", "flip", "coverage", "psnr_full_frame", "depth_median_abs_m"}) {
      if (all.is_object() && all.contains(key)) json[key] = all.at(key);
    }
    json["report"] = (project.ReportFolder() / "index.html").string();
  }
  return json;
}

Json DescribeJson(const std::filesystem::path& file) {
  const Json content = Json::parse(base::ReadFile(file), nullptr, false);
  if (content.is_discarded()) throw base::InputError(file, "is not valid JSON", "Make it again with the command that wrote it");
  Json json = {{"what", "JSON file of skyquilt"}, {"bytes", std::filesystem::file_size(file)}};
  if (file.filename() == "metrics.json") json["what"] = "metrics";
  if (file.filename() == "simulate.json") json["what"] = "simulated survey";
  if (file.filename() == "train.json") json["what"] = "training report";
  json["content"] = content;
  return json;
}

}  // namespace

nlohmann::ordered_json Describe(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) throw base::InputError(path, "no such file or folder", "Check the path");
  if (std::filesystem::is_directory(path)) {
    if (coordinator::Project::IsProject(path)) return DescribeProject(path);
    if (std::filesystem::exists(path / "survey.json")) return DescribeSurvey(path);
    if (std::filesystem::exists(path / "simulate.json")) return DescribeJson(path / "simulate.json");
    throw base::InputError(path, "is not a folder made by skyquilt", "Give a project folder, a survey folder or a simulated survey");
  }
  const std::string name = path.filename().string();
  const std::string extension = path.extension().string();
  if (name == "survey.json" || name == "points.ply" || name == "kept_points.ply" || name == "tracks.bin") return DescribeSurvey(path.parent_path());
  if (name == "cameras.geojson") return DescribeCameras(path);
  if (extension == ".geojson") return DescribeBlocks(path);
  if (extension == ".csv") return DescribeTable(path);
  if (extension == ".toml") return DescribeConfiguration(path);
  if (extension == ".h5" || extension == ".prev") return DescribeArchive(path);
  if (extension == ".tif" || extension == ".tiff") return DescribeRaster(path);
  if (extension == ".json") return DescribeJson(path);
  throw base::InputError(path, "is not a file that 'skyquilt info' can read",
                         "Give a project or survey folder, or a .geojson, .h5, .json, .csv, .toml, points.ply or .tif file");
}

}  // namespace skyquilt::app
