#include "bench/study/data_set.h"

#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kForms =
    "Give the folder of one scene: with transforms_train.json (Blender, MatrixCity), poses_bounds.npy (LLFF) or sparse/0 (Mip-NeRF 360)";

// MatrixCity's files are in pose/BLOCK and name pictures from there.
bool NamesPicturesFarAway(const fs::path& transforms) {
  const nlohmann::json json = base::TryParseJson(base::ReadFile(transforms));
  if (!json.is_object() || !json.contains("frames") || !json.at("frames").is_array() || json.at("frames").empty()) return false;
  const nlohmann::json& frame = json.at("frames").front();
  return frame.is_object() && frame.value("file_path", nlohmann::json()).is_string() &&
         frame.at("file_path").get<std::string>().starts_with("../../");
}

}  // namespace

DataSet FindDataSet(const fs::path& folder, const std::string& pictures) {
  if (!fs::is_directory(folder)) throw base::InputError(folder, "no such folder", kForms);
  DataSet set;
  set.model = folder;
  if (fs::is_regular_file(folder / "transforms_train.json")) {
    const bool far_away = NamesPicturesFarAway(folder / "transforms_train.json");
    set.name = far_away ? "MatrixCity" : "Blender";
    set.pictures = far_away ? fs::absolute(folder).lexically_normal() / ".." / ".." : folder;
    if (!far_away) set.overrides = {{"prepare.alpha", "white"}};
    set.pictures = set.pictures.lexically_normal();
    if (!pictures.empty()) set.pictures = folder / pictures;
  } else if (fs::is_regular_file(folder / "poses_bounds.npy") || fs::is_directory(folder / "sparse" / "0")) {
    const bool llff = fs::is_regular_file(folder / "poses_bounds.npy");
    set.name = llff ? "LLFF" : "Mip-NeRF 360";
    // Views from the front of a scene do not tell which way is up.
    if (llff) set.overrides = {{"prepare.up", "cameras"}};
    for (const char* name : {"images_4", "images_8", "images_2", "images"}) {
      if (set.pictures.empty() && fs::is_directory(folder / name)) set.pictures = folder / name;
    }
    if (!pictures.empty()) set.pictures = folder / pictures;
    if (set.pictures.empty())
      throw base::InputError(folder, "has none of the folders images_4, images_8, images_2 and images", "Unpack its pictures");
  } else {
    throw base::InputError(folder, "is none of the known data sets", kForms);
  }
  if (!fs::is_directory(set.pictures)) throw base::InputError(set.pictures, "no such folder", "Give one of the set's folders as --pictures");
  return set;
}

}  // namespace skyquilt::bench
