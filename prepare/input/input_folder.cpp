#include "prepare/input/input_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/input/file_names.h"
#include "prepare/input/list_files.h"
#include "prepare/models/metashape_xml.h"
#include "prepare/models/read_model.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

void RequireFolder(const fs::path& folder, const std::string& fix) {
  if (!fs::exists(folder)) throw base::InputError(folder, "no such folder", fix);
  if (!fs::is_directory(folder)) throw base::InputError(folder, "is a file, not a folder", fix);
}

// Masks and maps beside images/ are no photos.
bool HoldsPhotosDirectly(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    if (IsSharedMaskStem(stem) || IsMapStem(stem)) continue;
    if (entry.is_regular_file() && LooksLikePhoto(entry.path())) return true;
  }
  return false;
}

std::string UnusedModelText(const fs::path& model) {
  switch (models::FindModel(model).format) {
    case models::ModelFormat::kColmap:
      return "a COLMAP model";
    case models::ModelFormat::kTransforms:
      return "a transforms.json (nerfstudio)";
    case models::ModelFormat::kOpensfm:
      return "a reconstruction.json (OpenSfM, OpenDroneMap)";
    case models::ModelFormat::kMetashape:
      return "cameras of Metashape";
    case models::ModelFormat::kPosesBounds:
      return "a poses_bounds.npy (LLFF)";
    case models::ModelFormat::kOpf:
      break;
  }
  return "a Pix4D project";
}

// A model nearby may be what the user wants, or a left-over.
void NameUnusedModels(const std::vector<fs::path>& models) {
  for (const fs::path& model : models) {
    try {
      base::LogInfo("found {} in {}, which is not used; give it with --model {} to use it instead of running COLMAP", UnusedModelText(model),
                    model.string(), model.string());
    } catch (const base::InputError& error) {
      base::LogInfo("not used: {}", error.what());
    }
  }
}

void ReadSimulated(const fs::path& folder, bool own_model, InputFolder& found) {
  const fs::path file = folder / "simulate.json";
  const std::string fix = "Run 'skyquilt simulate' again";
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(file));
    if (own_model && json.value("exact_frame", false)) {
      const nlohmann::json& origin = json.at("origin");
      found.exact_origin =
          geo::Geodetic{origin.at("latitude_deg").get<double>(), origin.at("longitude_deg").get<double>(), origin.at("height_m").get<double>()};
      if (!geo::IsValid(*found.exact_origin)) throw base::InputError(file, "has an origin that is not a valid latitude, longitude and height", fix);
    }
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged (") + error.what() + ")", fix);
  }
  const fs::path truth = folder / "truth";
  if (fs::is_directory(truth)) {
    found.truth = survey::Truth{truth / "depth", truth / "buildings.json", truth / "exposure.json"};
    if (fs::is_directory(truth / "normals")) found.truth->normals_folder = truth / "normals";
    if (fs::is_directory(truth / "classes")) found.truth->classes_folder = truth / "classes";
    if (fs::is_regular_file(truth / "surface.ply")) found.truth->surface_ply = truth / "surface.ply";
    if (fs::is_directory(truth / "masks")) found.truth->masks_folder = truth / "masks";
    if (fs::is_regular_file(truth / "orthophoto.tif")) found.truth->ortho_tif = truth / "orthophoto.tif";
    if (fs::is_regular_file(truth / "edge_targets.json")) found.truth->edge_targets_json = truth / "edge_targets.json";
  }
}

}  // namespace

std::vector<fs::path> ModelsIn(const fs::path& folder) {
  std::vector<fs::path> models;
  std::error_code ignored;
  for (const char* name :
       {"sparse/0", "transforms.json", "transforms_train.json", "poses_bounds.npy", "reconstruction.json", "opensfm/reconstruction.json"}) {
    const fs::path model = folder / name;
    if (!fs::exists(model, ignored)) continue;
    const bool is_split = model.filename() == "transforms_train.json";
    if (model.filename() == "poses_bounds.npy" && fs::exists(folder / "sparse" / "0", ignored)) continue;  // made from it
    models.push_back(is_split && !fs::exists(folder / "transforms.json", ignored) ? folder : model);
  }
  std::vector<fs::path> others;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    std::error_code no_file;
    if (!entry->is_regular_file(no_file)) continue;
    const std::string extension = base::LowerCase(entry->path().extension().string());
    if (extension == ".opf" || (extension == ".xml" && models::LooksLikeMetashape(entry->path()))) others.push_back(entry->path());
  }
  std::sort(others.begin(), others.end());
  models.insert(models.end(), others.begin(), others.end());
  return models;
}

InputFolder FindInputs(const fs::path& photos, const fs::path& model, const std::string& masks) {
  RequireFolder(photos, "Give the folder that holds the photos");
  const fs::path folder = fs::canonical(photos);
  InputFolder found;
  found.photo_root = folder;
  const bool simulated = fs::exists(folder / "simulate.json");
  if (fs::is_directory(folder / "images") && (simulated || !HoldsPhotosDirectly(folder))) found.photo_root = folder / "images";

  // Around the photos: beside images/ (or images_4/), too, when that itself was given.
  std::vector<fs::path> nearby = ModelsIn(found.photo_root);
  const std::string own_name = folder.filename().string();
  if (found.photo_root != folder || own_name == "images" || own_name.starts_with("images_")) {
    const std::vector<fs::path> beside = ModelsIn(found.photo_root.parent_path());
    nearby.insert(nearby.end(), beside.begin(), beside.end());
  }
  std::vector<fs::path> transforms;
  if (!model.empty()) {
    const models::ModelFiles files = models::FindModel(model);  // before hours of work
    found.model = fs::canonical(files.path);
    if (files.format == models::ModelFormat::kTransforms && fs::is_regular_file(found.model)) transforms.push_back(found.model);
  } else if (simulated) {
    found.model = folder / "sparse" / "0";
  } else {
    NameUnusedModels(nearby);
  }
  if (simulated) ReadSimulated(folder, model.empty() || fs::equivalent(found.model, folder / "sparse" / "0"), found);

  for (const fs::path& one : nearby) {
    if (one.filename() == "transforms.json" && one != found.model) transforms.push_back(one);
  }
  found.masks = FindMaskPlaces(found.photo_root, masks, transforms);
  return found;
}

}  // namespace skyquilt::prepare::input
