#include "viewer/data/saved_documents.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "viewer/data/gcp_list.h"

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxFeatures = 5000;
constexpr size_t kMaxGcps = 10'000;
constexpr size_t kMaxViews = 10'000;
constexpr size_t kMaxText = 1000;
constexpr int kMaxDepth = 16;

// What is wrong with a document; becomes the answer.
class Refused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

DataReply TextReply(int status, const std::string& text) {
  return {.status = status, .content_type = "text/plain; charset=utf-8", .body = text, .file = {}};
}

void RequireText(const Json& object, const char* key, const std::string& where) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_string() || at->get_ref<const std::string&>().empty() || at->get_ref<const std::string&>().size() > kMaxText) {
    throw Refused(where + "." + key + " must be a text of 1 to " + std::to_string(kMaxText) + " characters");
  }
}

void RequireFinite(const Json& value, const std::string& where) {
  if (!value.is_number() || !(std::abs(value.get<double>()) <= 1e9)) throw Refused(where + " must be a number");
}

int DepthOf(const Json& json) {
  if (!json.is_structured()) return 0;
  int deepest = 0;
  for (const Json& child : json) deepest = std::max(deepest, DepthOf(child));
  return 1 + deepest;
}

// Positions of a geometry, however nested.
void CheckCoordinates(const Json& coordinates, const std::string& where) {
  if (!coordinates.is_array() || coordinates.empty()) throw Refused(where + " must be a list");
  if (!coordinates[0].is_array()) {
    if (coordinates.size() < 2 || coordinates.size() > 4) throw Refused(where + " must have 2 or 3 numbers");
    for (const Json& number : coordinates) RequireFinite(number, where);
    return;
  }
  for (const Json& child : coordinates) CheckCoordinates(child, where);
}

void CheckMeasurements(const Json& json) {
  if (!json.is_object() || json.value("type", Json()) != "FeatureCollection" || !json.contains("features") || !json["features"].is_array()) {
    throw Refused("it is not a GeoJSON FeatureCollection");
  }
  if (json["features"].size() > kMaxFeatures) throw Refused("it has more than " + std::to_string(kMaxFeatures) + " features");
  for (size_t i = 0; i < json["features"].size(); ++i) {
    const Json& feature = json["features"][i];
    const std::string where = "features[" + std::to_string(i) + "]";
    if (!feature.is_object() || feature.value("type", Json()) != "Feature") throw Refused(where + " is not a Feature");
    if (!feature.contains("properties") || !feature["properties"].is_object()) throw Refused(where + ".properties must be an object");
    const Json& geometry = feature.contains("geometry") ? feature["geometry"] : Json();
    static const std::set<std::string> kTypes = {"Point", "MultiPoint", "LineString", "Polygon"};
    if (!geometry.is_object() || !geometry.contains("type") || !geometry["type"].is_string() ||
        !kTypes.contains(geometry["type"].get<std::string>())) {
      throw Refused(where + ".geometry must be a Point, MultiPoint, LineString or Polygon");
    }
    CheckCoordinates(geometry.contains("coordinates") ? geometry["coordinates"] : Json(), where + ".geometry.coordinates");
  }
}

void CheckGcps(const Json& json) {
  if (!json.is_object() || !json.contains("points") || !json["points"].is_array()) throw Refused("it is not a list of control points");
  if (!json.contains("crs") || !(json["crs"].is_null() || json["crs"].is_string())) throw Refused("crs must be a text or null");
  if (json["crs"].is_string()) {
    const std::string& crs = json["crs"].get_ref<const std::string&>();
    if (crs.empty() || crs.size() > kMaxText || crs.find('\n') != std::string::npos) throw Refused("crs must be one line");
  }
  if (json["points"].size() > kMaxGcps) throw Refused("it has more than " + std::to_string(kMaxGcps) + " control points");
  std::set<std::string> names;
  for (size_t i = 0; i < json["points"].size(); ++i) {
    const Json& point = json["points"][i];
    const std::string where = "points[" + std::to_string(i) + "]";
    if (!point.is_object()) throw Refused(where + " must be an object");
    RequireText(point, "name", where);
    if (!names.insert(point["name"]).second) throw Refused(where + ".name is the name of another point too");
    for (const char* axis : {"x", "y", "z"}) RequireFinite(point.contains(axis) ? point[axis] : Json(), where + "." + axis);
    if (!point.contains("marks") || !point["marks"].is_array()) throw Refused(where + ".marks must be a list");
    for (const Json& mark : point["marks"]) {
      if (!mark.is_object()) throw Refused(where + ".marks must hold objects");
      RequireText(mark, "photo", where + ".marks");
      const Json pixel = mark.contains("pixel") ? mark["pixel"] : Json();
      if (!pixel.is_array() || pixel.size() != 2) throw Refused(where + ".marks.pixel must have 2 numbers");
      for (const Json& number : pixel) RequireFinite(number, where + ".marks.pixel");
    }
  }
}

// The rules of `render --path` for what the viewer writes (products/camera_path.h).
void CheckCameraPath(const Json& json) {
  const Json& views = json.is_object() && json.contains("views") ? json["views"] : json;
  if (!views.is_array()) throw Refused("it is not a camera path: it must be a list of views, or an object with such a list as \"views\"");
  if (views.size() > kMaxViews) throw Refused("it has more than " + std::to_string(kMaxViews) + " views");
  static const std::set<std::string> kKeys = {"position_enu", "longitude", "latitude", "height", "yaw", "pitch", "roll", "fov", "name"};
  for (size_t i = 0; i < views.size(); ++i) {
    const std::string where = "views[" + std::to_string(i) + "]";
    if (!views[i].is_object()) throw Refused(where + " is not an object");
    for (const auto& item : views[i].items()) {
      if (!kKeys.contains(item.key())) throw Refused(where + " has a key that 'render --path' does not know");
      if (item.key() == "name") {
        RequireText(views[i], "name", where);
      } else if (item.key() == "position_enu") {
        if (!item.value().is_array() || item.value().size() != 3) throw Refused(where + ".position_enu must have 3 numbers");
        for (const Json& number : item.value()) RequireFinite(number, where + ".position_enu");
      } else {
        RequireFinite(item.value(), where + "." + item.key());
      }
    }
    const bool placed =
        views[i].contains("position_enu") || (views[i].contains("longitude") && views[i].contains("latitude") && views[i].contains("height"));
    if (!placed) throw Refused(where + " has no position");
  }
}

Json Checked(const std::string& name, const std::string& body) {
  Json json = Json::parse(body, nullptr, false);
  if (json.is_discarded()) throw Refused("it is not JSON");
  if (DepthOf(json) > kMaxDepth) throw Refused("it is nested too deeply");
  if (name == "measurements.geojson") CheckMeasurements(json);
  if (name == "gcp.json") CheckGcps(json);
  if (name == "camera_path.json") CheckCameraPath(json);
  return json;
}

// Nothing when the file does not exist or cannot be read.
std::string Content(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return "";
  try {
    return base::ReadFile(file);
  } catch (const base::InputError&) {
    return "";
  }
}

// Keys stay in the order of the client.
std::string Indented(const std::string& body) {
  return nlohmann::ordered_json::parse(body).dump(1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

void WriteGcpList(const std::filesystem::path& folder, const std::string& old_json, const Json& gcp) {
  const std::filesystem::path list = folder / "gcp_list.txt", original = folder / "gcp_list.txt.orig";
  const std::string present = Content(list), wanted = GcpListText(gcp);
  if (present == wanted) return;
  const Json old = Json::parse(old_json, nullptr, false);
  const bool ours = !old_json.empty() && !old.is_discarded() && old.contains("points") && GcpListText(old) == present;
  if (!present.empty() && !ours && !std::filesystem::exists(original)) base::WriteFileAtomically(original, present);
  base::WriteFileAtomically(list, wanted);
}

// 403 for a folder that may not be written, else 507: the disk is full.
int StatusOfFailure(const std::filesystem::path& folder) {
  return access(folder.c_str(), W_OK) != 0 ? 403 : 507;
}

}  // namespace

bool IsDocument(const std::string& name) {
  return name == "measurements.geojson" || name == "gcp.json" || name == "camera_path.json";
}

DataReply GetDocument(const OpenedProject& opened, const std::string& name) {
  const std::filesystem::path& folder = opened.project.folder;
  const char* type = name == "measurements.geojson" ? "application/geo+json" : "application/json";
  std::error_code error;
  if (std::filesystem::is_regular_file(folder / name, error)) {
    return {.status = 200, .content_type = type, .body = base::ReadFile(folder / name), .file = {}};
  }
  if (name == "gcp.json") {
    std::vector<std::filesystem::path> lists = {folder / "gcp_list.txt"};
    if (opened.survey != nullptr) {
      lists.push_back(opened.survey->photo_root / "gcp_list.txt");
      lists.push_back(opened.survey->photo_root.parent_path() / "gcp_list.txt");
    }
    for (const std::filesystem::path& list : lists) {
      const std::string text = Content(list);
      if (!text.empty())
        return {.status = 200, .content_type = type, .body = ReadGcpList(text).dump(-1, ' ', false, Json::error_handler_t::replace), .file = {}};
    }
  }
  return {.status = 204, .content_type = "", .body = "", .file = {}};
}

DataReply PutDocument(const OpenedProject& opened, const std::string& name, const std::string& body) {
  const std::filesystem::path& folder = opened.project.folder;
  Json json;
  try {
    json = Checked(name, body);
  } catch (const Refused& refused) {
    return TextReply(400, name + " was not saved: " + refused.what());
  }
  const std::filesystem::path file = folder / name;
  const std::string old = Content(file), wanted = Indented(body);
  try {
    if (old != wanted) base::WriteFileAtomically(file, wanted);
    if (name == "gcp.json") WriteGcpList(folder, old, json);
  } catch (const base::InputError& failure) {
    const int status = StatusOfFailure(folder);
    spdlog::warn("{}", failure.what());
    return TextReply(status, name + " was not saved: " + failure.what());
  }
  return {.status = 204, .content_type = "", .body = "", .file = {}};
}

}  // namespace skyquilt::viewer
