#include "prepare/rigs/rig_config.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/errors.h"
#include "core/base/json_document.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::prepare::rigs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFix =
    "Write it as COLMAP's documentation says (Rig Support): a list of rigs with cameras, each with image_prefix, one with ref_sensor, the others "
    "with "
    "cam_from_rig_rotation (w, x, y, z) and cam_from_rig_translation (metres)";

geo::Rigid3d PlaceOf(const base::JsonValue& camera) {
  const std::vector<double> wxyz = camera.At("cam_from_rig_rotation").Numbers(4);
  const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  constexpr double kMostOff = 0.01;
  if (!(std::abs(rotation.norm() - 1.0) <= kMostOff)) {
    camera.At("cam_from_rig_rotation").Fail("must be a rotation: four numbers w, x, y, z whose squares sum to 1");
  }
  const std::vector<double> xyz = camera.At("cam_from_rig_translation").Numbers(3);
  return {rotation.normalized(), {xyz[0], xyz[1], xyz[2]}};
}

// COLMAP's name of the model and its parameters, of models without distortion; others say less than what is found from the photos.
void ReadLens(const base::JsonValue& json, RigCamera& camera) {
  const std::optional<base::JsonValue> model = json.Find("camera_model_name");
  if (!model) return;
  const std::string name = model->Text();
  if (name != "PINHOLE" && name != "SIMPLE_PINHOLE") return;
  const std::optional<base::JsonValue> params = json.Find("camera_params");
  if (!params) return;
  camera.model = name;
  camera.params = params->Numbers(name == "PINHOLE" ? 4 : 3);
  if (!(camera.params.front() > 0.0)) params->Fail("must begin with a focal length in pixels");
}

// In pixels, of photos for which this is their whole lens.
std::optional<double> ExactFocal(const RigCamera& camera, const input::PhotoFile& photo) {
  if (camera.params.empty()) return std::nullopt;
  constexpr double kMostOff = 1e-3;  // share of the focal length
  const std::vector<double>& params = camera.params;
  const double focal = params.front(), centre_x = params[params.size() - 2], centre_y = params.back();
  const bool square = std::abs(params[params.size() - 3] - focal) <= kMostOff * focal;
  const bool middle = std::abs(2.0 * centre_x - photo.width) <= 1.0 && std::abs(2.0 * centre_y - photo.height) <= 1.0;
  return square && middle ? std::optional(focal) : std::nullopt;
}

Rig ReadRig(const base::JsonValue& json, std::set<std::string>* prefixes) {
  Rig rig;
  bool has_reference = false;
  const base::JsonValue cameras = json.At("cameras");
  for (size_t i = 0; i < cameras.Size(); ++i) {
    const base::JsonValue one = cameras.At(i);
    RigCamera camera{.prefix = one.At("image_prefix").Text(), .cam_from_rig = {}};
    if (!prefixes->insert(camera.prefix).second) one.At("image_prefix").Fail("is the prefix of another camera, too");
    const std::optional<base::JsonValue> reference = one.Find("ref_sensor");
    const bool is_reference = reference && reference->Boolean();
    if (is_reference && has_reference) one.At("ref_sensor").Fail("is true for a second camera of the rig");
    has_reference = has_reference || is_reference;
    if (!is_reference) camera.cam_from_rig = PlaceOf(one);
    ReadLens(one, camera);
    rig.cameras.insert(is_reference ? rig.cameras.begin() : rig.cameras.end(), std::move(camera));
  }
  if (!has_reference) json.Fail("has no camera with ref_sensor = true");
  return rig;
}

struct Place {
  size_t rig = 0, camera = 0;
  std::string rest;  // of the name
};

std::optional<Place> PlaceOfName(const std::vector<Rig>& rigs, const std::string& name) {
  std::optional<Place> place;
  size_t longest = 0;
  for (size_t r = 0; r < rigs.size(); ++r) {
    for (size_t c = 0; c < rigs[r].cameras.size(); ++c) {
      const std::string& prefix = rigs[r].cameras[c].prefix;
      if (!name.starts_with(prefix) || prefix.size() <= longest) continue;
      longest = prefix.size();
      place = Place{r, c, name.substr(prefix.size())};
    }
  }
  return place;
}

}  // namespace

std::vector<Rig> ReadRigConfig(const fs::path& file) {
  const base::JsonDocument document(file, kFix);
  std::vector<Rig> rigs;
  std::set<std::string> prefixes;
  const base::JsonValue root = document.Root();
  for (size_t i = 0; i < root.Size(); ++i) rigs.push_back(ReadRig(root.At(i), &prefixes));
  if (rigs.empty()) throw base::InputError(file, "has no rig", kFix);
  return rigs;
}

std::string RigConfigText(const std::vector<Rig>& rigs) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Rig& rig : rigs) {
    nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
    for (const RigCamera& camera : rig.cameras) {
      nlohmann::ordered_json& one = cameras.emplace_back(nlohmann::ordered_json{{"image_prefix", camera.prefix}});
      if (cameras.size() == 1) {
        one["ref_sensor"] = true;
      } else {
        const Eigen::Quaterniond& r = camera.cam_from_rig.rotation;
        const Eigen::Vector3d& t = camera.cam_from_rig.translation;
        one["cam_from_rig_rotation"] = {r.w(), r.x(), r.y(), r.z()};
        one["cam_from_rig_translation"] = {t.x(), t.y(), t.z()};
      }
      if (camera.model.empty()) continue;
      one["camera_model_name"] = camera.model;
      one["camera_params"] = camera.params;
    }
    json.push_back({{"cameras", std::move(cameras)}});
  }
  return base::JsonText(json, 1) + "\n";
}

fs::path FindRigConfig(const fs::path& photo_root, const std::string& option) {
  if (option == "none") return {};
  if (!option.empty()) {
    if (!fs::is_regular_file(option)) {
      throw base::InputError(option, "no such file", "Give COLMAP's rig_config.json of the cameras as prepare.rig, or leave it empty");
    }
    return fs::absolute(option);
  }
  for (const fs::path& folder : {photo_root, photo_root.filename() == "images" ? photo_root.parent_path() : photo_root}) {
    if (fs::is_regular_file(folder / "rig_config.json")) return folder / "rig_config.json";
  }
  return {};
}

void UseRigs(const std::vector<Rig>& rigs, const fs::path& file, std::vector<input::PhotoFile>& photos) {
  std::map<std::string, size_t> n_of_shot;
  size_t n_placed = 0, n_alone = 0, n_exact = 0;
  for (input::PhotoFile& photo : photos) {
    const std::optional<Place> place = PlaceOfName(rigs, photo.name);
    if (!place) {
      ++n_alone;
      continue;
    }
    const RigCamera& camera = rigs[place->rig].cameras[place->camera];
    const std::string shot = rigs.size() > 1 ? fmt::format("rig {}: {}", place->rig + 1, place->rest) : place->rest;
    photo.rig = input::RigPlace{.rig = file.string(),
                                .shot = shot,
                                .camera = camera.prefix,
                                .cam_from_rig = camera.cam_from_rig,
                                .exact_focal_px = ExactFocal(camera, photo)};
    if (photo.rig->exact_focal_px) ++n_exact;
    ++n_of_shot[shot];
    ++n_placed;
  }
  const bool any = std::any_of(n_of_shot.begin(), n_of_shot.end(), [](const auto& shot) { return shot.second > 1; });
  if (!any) {
    throw base::InputError(file,
                           n_placed == 0 ? fmt::format("has no image_prefix with which one of the {} photos begins, such as {}", photos.size(),
                                                       photos.empty() ? "none" : photos.front().name)
                                         : "makes no shot of two photos: their names differ behind the prefixes",
                           "Photos of one shot need the same name behind image_prefix (front/0001.jpg and back/0001.jpg), relative to the photo "
                           "folder; or set prepare.rig = none");
  }
  base::LogInfo("{}: {} photos are of {} shots of a rig{}{}", file.string(), n_placed, n_of_shot.size(),
                n_alone > 0 ? fmt::format(", {} have none of its prefixes and stand alone", n_alone) : "",
                n_exact > 0 ? fmt::format("; the lenses of {} are kept, because it says that they have no distortion", n_exact) : "");
}

}  // namespace skyquilt::prepare::rigs
