#include "viewer/data/gcp_json.h"

#include <nlohmann/json.hpp>

#include "core/base/checked_json.h"
#include "core/base/json_document.h"

namespace skyquilt::viewer {
namespace {

using Json = nlohmann::json;

constexpr size_t kMaxPhotoName = 4096;

std::vector<std::string> NamesOf(const survey::Survey* survey) {
  if (survey == nullptr) return {};
  std::vector<std::string> names = survey->unregistered;
  for (const survey::Photo& photo : survey->photos) names.push_back(photo.name);
  return names;
}

void CheckMark(const Json& mark, const MarkablePhotos& photos, const std::set<std::string>& allowed, const std::string& where) {
  if (!mark.is_object() || !mark.contains("photo") || !mark.contains("pixel")) throw base::Refused(where + " must have photo and pixel");
  base::JsonValue(mark["photo"], where + ".photo").Text(kMaxPhotoName);
  const Json& pixel = mark["pixel"];
  if (!pixel.is_array() || pixel.size() != 2) throw base::Refused(where + ".pixel must have 2 numbers");
  for (const Json& number : pixel) base::JsonValue(number, where + ".pixel").Number();
  const std::string name = mark["photo"];
  if (!photos.Has(name)) {
    const bool said = mark.contains("unknown") && mark["unknown"].is_boolean() && mark["unknown"].get<bool>();
    if (!said && !allowed.contains(name)) throw base::Refused(where + ": the survey has no photo \"" + name + "\"");
  } else if (!photos.Contains(name, pixel[0], pixel[1])) {
    throw base::Refused(where + ".pixel is outside the photo \"" + name + "\"");
  }
}

}  // namespace

MarkablePhotos::MarkablePhotos(const survey::Survey* survey) : names_(NamesOf(survey)), finder_(names_) {
  if (survey == nullptr) return;
  for (const survey::Photo& photo : survey->photos) photos_[photo.name] = &survey->cameras[static_cast<size_t>(photo.camera)];
  for (const std::string& name : survey->unregistered) photos_.emplace(name, nullptr);
}

bool MarkablePhotos::Contains(const std::string& name, double x, double y) const {
  const auto at = photos_.find(name);
  if (at == photos_.end() || !(x >= 0.0 && y >= 0.0)) return false;
  return at->second == nullptr || (x <= at->second->width && y <= at->second->height);
}

std::string MarkablePhotos::Find(const std::string& name) const {
  const std::optional<size_t> found = finder_.Find(name);
  return found ? names_[*found] : "";
}

std::string MarkablePhotos::ShortName(const std::string& name) const {
  const std::string file_name = name.substr(name.find_last_of("/\\") + 1);
  return Find(file_name) == (Has(name) ? name : "") ? file_name : name;
}

std::optional<std::string> CrsNameOf(bool georeferenced, const geo::UtmZone& zone) {
  if (!georeferenced) return {};
  return "EPSG:" + std::to_string(zone.Epsg());
}

std::set<std::string> UnknownMarks(const Json& gcp, const MarkablePhotos& photos) {
  std::set<std::string> unknown;
  if (!gcp.is_object() || !gcp.contains("points") || !gcp["points"].is_array()) return unknown;
  for (const Json& point : gcp["points"]) {
    if (!point.is_object() || !point.contains("marks") || !point["marks"].is_array()) continue;
    for (const Json& mark : point["marks"]) {
      if (!mark.is_object() || !mark.contains("photo") || !mark["photo"].is_string()) continue;
      if (std::string name = mark["photo"]; !photos.Has(name)) unknown.insert(std::move(name));
    }
  }
  return unknown;
}

void CheckControlPoints(const Json& gcp, const std::optional<std::string>& crs, const MarkablePhotos& photos, const std::set<std::string>& allowed) {
  if (!gcp.is_object() || !gcp.contains("points") || !gcp["points"].is_array() || !gcp.contains("crs")) {
    throw base::Refused("it is not a list of control points with its crs");
  }
  if (gcp["crs"] != (crs ? Json(*crs) : Json(nullptr))) {
    throw base::Refused("crs must be " + (crs ? *crs + ", the CRS of this project" : "null, because this project has no geo-reference"));
  }
  const Json& points = gcp["points"];
  if (points.size() > kMaxControlPoints) throw base::Refused("it has more than " + std::to_string(kMaxControlPoints) + " control points");
  std::set<std::string> names;
  for (size_t i = 0; i < points.size(); ++i) {
    const Json& point = points[i];
    const std::string where = "points[" + std::to_string(i) + "]";
    if (!point.is_object() || !point.contains("name")) throw base::Refused(where + " must have a name");
    base::JsonValue(point["name"], where + ".name").Text(kMaxPointName);
    if (!names.insert(point["name"]).second) throw base::Refused(where + ".name is the name of another point too");
    for (const char* axis : {"x", "y", "z"}) base::JsonValue(point.contains(axis) ? point[axis] : Json(), where + "." + axis).Number();
    if (!point.contains("marks") || !point["marks"].is_array()) throw base::Refused(where + ".marks must be a list");
    std::set<std::string> marked;
    for (size_t k = 0; k < point["marks"].size(); ++k) {
      const Json& mark = point["marks"][k];
      const std::string mark_where = where + ".marks[" + std::to_string(k) + "]";
      CheckMark(mark, photos, allowed, mark_where);
      if (!marked.insert(mark["photo"]).second) throw base::Refused(mark_where + ": the point is marked in this photo already");
    }
  }
}

}  // namespace skyquilt::viewer
