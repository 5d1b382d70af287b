#include "viewer/data/check_document.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/json_document.h"
#include "products/camera_path.h"

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxFeatures = 5000;
constexpr size_t kMaxNameBytes = 800;  // 200 characters of any script
constexpr int64_t kMaxFrames = 200'000;

const Json& MemberOf(const Json& object, const char* key) {
  static const Json missing;
  if (!object.is_object()) return missing;
  const auto at = object.find(key);
  return at == object.end() ? missing : *at;
}

void CheckPosition(const Json& position, const std::string& where) {
  if (!position.is_array() || position.size() < 2 || position.size() > 4) throw base::Refused(where + " must have a position of 2 or 3 numbers");
  for (const Json& number : position) base::JsonValue(number, where).Number();
}

void CheckPositions(const Json& positions, size_t least, const std::string& where) {
  if (!positions.is_array() || positions.size() < least) throw base::Refused(where + " must have at least " + std::to_string(least) + " positions");
  for (const Json& position : positions) CheckPosition(position, where);
}

void CheckGeometry(const Json& geometry, const std::string& where) {
  const Json& type = MemberOf(geometry, "type");
  const Json& coordinates = MemberOf(geometry, "coordinates");
  if (type == "Point") {
    CheckPosition(coordinates, where);
  } else if (type == "LineString") {
    CheckPositions(coordinates, 2, where);
  } else if (type == "Polygon") {
    if (!coordinates.is_array() || coordinates.empty()) throw base::Refused(where + " must have a ring");
    for (const Json& ring : coordinates) CheckPositions(ring, 4, where);
  } else {
    throw base::Refused(where + " must be a Point, LineString or Polygon");
  }
}

const Json& ViewsOf(const Json& json) {
  return json.is_object() && json.contains("views") ? json["views"] : json;
}

// Reading a path makes all its frames.
void CheckFrameCount(const Json& json) {
  const auto views = static_cast<int64_t>(ViewsOf(json).size());
  const Json& between = MemberOf(json, "frames_between");
  const double each = between.is_number() ? std::abs(between.get<double>()) : 0.0;
  if (!(static_cast<double>(views) * (each + 1.0) <= static_cast<double>(kMaxFrames))) {
    throw base::Refused("it has more than " + std::to_string(kMaxFrames) + " frames: leave out key frames, or fly faster");
  }
}

}  // namespace

void CheckMeasurements(const Json& json) {
  const Json& features = MemberOf(json, "features");
  if (MemberOf(json, "type") != "FeatureCollection" || !features.is_array()) throw base::Refused("it is not a GeoJSON FeatureCollection");
  if (features.size() > kMaxFeatures) throw base::Refused("it has more than " + std::to_string(kMaxFeatures) + " features: delete some");
  for (size_t i = 0; i < features.size(); ++i) {
    const std::string where = "features[" + std::to_string(i) + "]";
    if (MemberOf(features[i], "type") != "Feature") throw base::Refused(where + " is not a Feature");
    const Json& properties = MemberOf(features[i], "properties");
    if (!properties.is_object()) throw base::Refused(where + ".properties must be an object");
    const Json& name = MemberOf(properties, "name");
    const bool nameless = name.is_null() || (name.is_string() && name.get_ref<const std::string&>().empty());
    if (!nameless) base::JsonValue(name, where + ".properties.name").Text(kMaxNameBytes);
    CheckGeometry(MemberOf(features[i], "geometry"), where + ".geometry");
  }
}

void CheckCameraPath(const Json& json, const std::string& text, const geo::Geodetic& origin, bool georeferenced) {
  CheckFrameCount(json);
  const Json& views = ViewsOf(json);
  for (size_t i = 0; i < views.size() && views.is_array(); ++i) {
    const Json& position = MemberOf(views[i], "position_enu");
    for (const Json& number : position) base::JsonValue(number, "views[" + std::to_string(i) + "].position_enu").Number();
  }
  scene::SceneInfo info;
  info.origin = origin;
  info.georeferenced = georeferenced;
  try {
    products::ParseCameraPath(text, "camera_path.json", info, 16, 9);
  } catch (const base::InputError& error) {
    throw base::Refused(error.finding());
  }
}

bool IsEmptyPath(const Json& json) {
  const Json& views = ViewsOf(json);
  return views.is_array() && views.empty();
}

}  // namespace skyquilt::viewer
