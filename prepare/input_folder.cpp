#include "prepare/input_folder.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "prepare/models/read_model.h"
#include "prepare/photo_files.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

void RequireFolder(const fs::path& folder, const std::string& fix) {
  if (!fs::exists(folder)) throw base::InputError(folder, "no such folder", fix);
  if (!fs::is_directory(folder)) throw base::InputError(folder, "is a file, not a folder", fix);
}

bool HoldsPhotosDirectly(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.is_regular_file() && LooksLikePhoto(entry.path())) return true;
  }
  return false;
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
  }
}

}  // namespace

InputFolder FindInputs(const fs::path& photos, const fs::path& model, const fs::path& masks) {
  RequireFolder(photos, "Give the folder that holds the photos");
  const fs::path folder = fs::canonical(photos);
  InputFolder found;
  found.photo_root = folder;
  const bool simulated = fs::exists(folder / "simulate.json");
  if (fs::is_directory(folder / "images") && (simulated || !HoldsPhotosDirectly(folder))) found.photo_root = folder / "images";

  if (!model.empty()) {
    found.model = fs::canonical(FindModel(model).path);  // before hours of work
  } else if (simulated) {
    found.model = folder / "sparse" / "0";
  } else if (fs::is_directory(folder / "sparse" / "0")) {
    base::LogInfo("found a COLMAP model in {}, which is not used; give it with --model to use it instead of running COLMAP",
                  (folder / "sparse" / "0").string());
  }
  if (simulated) ReadSimulated(folder, model.empty() || fs::equivalent(found.model, folder / "sparse" / "0"), found);

  if (!masks.empty()) {
    RequireFolder(masks, "Give the folder with masks named PHOTO.jpg.png");
    found.masks = fs::canonical(masks);
  } else if (fs::is_directory(folder / "masks")) {
    found.masks = folder / "masks";
  }
  return found;
}

}  // namespace skyquilt::prepare
