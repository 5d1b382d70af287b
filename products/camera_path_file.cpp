#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/config/options.h"
#include "core/geo/enu_frame.h"
#include "products/camera_path.h"

namespace skyquilt::products {
namespace {

using Json = nlohmann::json;

constexpr int kMaxFramesBetween = 10000;

struct KeyFrame {
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // cam_from_enu
  double fov_deg = 60.0;
  std::string name;
};

// One entry of the file. Every error message names it.
class Entry {
 public:
  Entry(const std::filesystem::path& file, const Json& json, size_t index) : file_(file), json_(json), index_(index) {
    if (!json.is_object()) Refuse("is not an object");
    const std::vector<std::string> known = {"position_enu", "longitude", "latitude", "height", "yaw", "pitch", "roll", "fov", "name"};
    for (const auto& item : json.items()) {
      if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
      const std::string nearest = config::Nearest(item.key(), known);
      Refuse("has the unknown key \"" + item.key() + "\"" + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
    }
  }
  [[noreturn]] void Refuse(const std::string& found) const {
    throw base::InputError(file_, "view " + std::to_string(index_) + " " + found,
                           "Each view needs position_enu or longitude, latitude and height, and may have yaw, pitch, roll, fov and name");
  }
  double Number(const std::string& key, std::optional<double> otherwise) const {
    if (!json_.contains(key)) {
      if (!otherwise) Refuse("has no \"" + key + "\"");
      return *otherwise;
    }
    if (!json_[key].is_number()) Refuse("has a \"" + key + "\" that is not a number");
    return json_[key].get<double>();
  }
  KeyFrame Read(const std::optional<geo::EnuFrame>& frame) const {
    KeyFrame key;
    if (json_.contains("position_enu")) {
      const Json& position = json_["position_enu"];
      if (!position.is_array() || position.size() != 3 ||
          !std::all_of(position.begin(), position.end(), [](const Json& x) { return x.is_number(); })) {
        Refuse("has a \"position_enu\" that is not three numbers");
      }
      key.eye_enu = {position[0].get<double>(), position[1].get<double>(), position[2].get<double>()};
    } else {
      const geo::Geodetic place{Number("latitude", {}), Number("longitude", {}), Number("height", {})};
      if (!frame) Refuse("is given by longitude and latitude, but the scene has no geo-reference");
      if (!geo::IsValid(place)) Refuse("has a position that is not on Earth: latitude " + std::to_string(place.latitude_deg));
      key.eye_enu = frame->EnuFromGeodetic(place);
    }
    key.rotation = PoseFromAngles(key.eye_enu, Number("yaw", 0.0), Number("pitch", 0.0), Number("roll", 0.0)).rotation;
    key.fov_deg = Number("fov", 60.0);
    if (!(key.fov_deg > 0.0 && key.fov_deg < 180.0)) Refuse("has fov " + std::to_string(key.fov_deg) + "; it must be between 0 and 180 degrees");
    if (json_.contains("name")) {
      if (!json_["name"].is_string()) Refuse("has a \"name\" that is not a text");
      key.name = json_["name"].get<std::string>();
      if (key.name.empty() || key.name.find('/') != std::string::npos || key.name.front() == '.') Refuse("has a \"name\" that cannot be a file name");
    }
    return key;
  }

 private:
  const std::filesystem::path& file_;
  const Json& json_;
  size_t index_;
};

std::vector<KeyFrame> Interpolate(const std::vector<KeyFrame>& keys, int frames_between) {
  if (frames_between == 0 || keys.size() < 2) return keys;
  std::vector<KeyFrame> frames;
  for (size_t i = 0; i + 1 < keys.size(); ++i) {
    const KeyFrame& before = keys[i == 0 ? 0 : i - 1];
    const KeyFrame& after = keys[std::min(i + 2, keys.size() - 1)];
    frames.push_back(keys[i]);
    for (int k = 1; k <= frames_between; ++k) {
      const double u = static_cast<double>(k) / (frames_between + 1);
      KeyFrame frame;
      frame.eye_enu = CatmullRom(before.eye_enu, keys[i].eye_enu, keys[i + 1].eye_enu, after.eye_enu, u);
      frame.rotation = keys[i].rotation.slerp(u, keys[i + 1].rotation);
      frame.fov_deg = (1.0 - u) * keys[i].fov_deg + u * keys[i + 1].fov_deg;
      frames.push_back(frame);
    }
  }
  frames.push_back(keys.back());
  return frames;
}

std::string NumberedName(size_t index) {
  const std::string digits = std::to_string(index);
  return "view_" + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits;
}

}  // namespace

std::vector<View> LoadCameraPath(const std::filesystem::path& file, const scene::SceneInfo& info, int width, int height) {
  return ParseCameraPath(base::ReadFile(file), file, info, width, height);
}

std::vector<View> ParseCameraPath(const std::string& text, const std::filesystem::path& file, const scene::SceneInfo& info, int width, int height) {
  if (width <= 0 || height <= 0)
    throw base::UsageError("the image size " + std::to_string(width) + " x " + std::to_string(height) +
                           " is not allowed: width and height must be positive");
  const Json root = Json::parse(text, nullptr, false);
  const bool is_object = root.is_object() && root.contains("views");
  const Json& list = is_object ? root["views"] : root;
  if (root.is_discarded() || !list.is_array() || list.empty()) {
    throw base::InputError(file, "is not a camera path", "It must be a JSON list of views, or an object with such a list as \"views\"");
  }
  int frames_between = 0;
  if (is_object && root.contains("frames_between")) {
    const Json& value = root["frames_between"];
    if (!value.is_number_integer() || value.get<int64_t>() < 0 || value.get<int64_t>() > kMaxFramesBetween) {
      throw base::InputError(file, "has a \"frames_between\" of " + base::JsonText(value), "It must be a whole number from 0 to 10000");
    }
    frames_between = value.get<int>();
  }
  std::optional<geo::EnuFrame> frame;
  if (info.georeferenced) frame.emplace(info.origin);
  std::vector<KeyFrame> keys;
  for (size_t i = 0; i < list.size(); ++i) keys.push_back(Entry(file, list[i], i).Read(frame));

  std::vector<View> views;
  std::set<std::string> taken;
  for (const KeyFrame& key : Interpolate(keys, frames_between)) {
    View view;
    view.name = key.name.empty() ? NumberedName(views.size()) : key.name;
    if (!taken.insert(view.name).second)
      throw base::InputError(file, "has two views with the name \"" + view.name + "\"", "Give each view its own name");
    view.camera = PinholeCamera(width, height, key.fov_deg);
    view.cam_from_enu.rotation = key.rotation;
    view.cam_from_enu.translation = -(key.rotation * key.eye_enu);
    views.push_back(view);
  }
  return views;
}

}  // namespace skyquilt::products
