#include "viewer/data/gcp_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <vector>

#include "core/base/errors.h"
#include "core/base/text.h"
#include "core/geo/crs.h"
#include "prepare/control/reading/odm_gcp_list.h"
#include "prepare/control/reading/point_places.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::viewer {
namespace {

namespace control = prepare::control;
using Json = nlohmann::json;

constexpr size_t kMaxListBytes = 4U << 20U;
constexpr size_t kMaxRemarks = 8;
// The list counts pixels from the middle of the first one, the viewer from its outer corner.
constexpr double kMiddle = 0.5;

bool IsBlank(char c) {
  return static_cast<unsigned char>(c) <= ' ';
}

std::string WithoutBlanks(std::string name) {
  std::replace_if(name.begin(), name.end(), IsBlank, '_');
  return name;
}

std::string Fixed(double value, int digits) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

// Whether the first line is LOCAL, which is no row.
bool TakeLocalLine(prepare::tables::TextTable& table) {
  if (!table.crs.empty() || table.rows.empty() || base::LowerCase(table.first_row) != "local") return false;
  table.rows.erase(table.rows.begin());
  return true;
}

// Coordinates in the project's maps (zone; none without geo-reference), and what is wrong with them, per point.
struct MapPlaces {
  std::vector<Eigen::Vector3d> places;
  std::vector<std::string> problems;  // empty: none
  std::vector<std::string> warnings = {};
};

MapPlaces PlacesOf(const control::RawControl& list, const std::optional<geo::UtmZone>& zone) {
  MapPlaces result{{}, std::vector<std::string>(list.points.size())};
  control::PointPlaces found;
  bool convert = false;
  if (zone) {
    found = control::PlacePoints(list, "", "");
    result.warnings = found.warnings;
    convert = found.crs != geo::Crs("EPSG:" + std::to_string(zone->Epsg())).name();
  }
  for (size_t i = 0; i < list.points.size(); ++i) {
    const control::RawPoint& point = list.points[i];
    Eigen::Vector3d place = point.given;
    if (convert) place << geo::UtmFromGeodetic(found.places[i], *zone), found.places[i].height_m;
    if (const auto problem = found.problems.find(i); problem != found.problems.end()) {
      result.problems[i] = problem->second.found;
    } else if (std::isnan(point.given.z())) {
      result.problems[i] = point.label + " has no height";
    } else if (point.named && point.label.size() > kMaxPointName) {
      result.problems[i] = "has a name of more than " + std::to_string(kMaxPointName) + " bytes";
    } else if (!place.allFinite()) {
      result.problems[i] = point.label + " is too far away";
    }
    result.places.push_back(place);
  }
  return result;
}

// A point has one mark in a photo: the last.
void SetMark(Json mark, Json& marks) {
  const auto same = std::find_if(marks.begin(), marks.end(), [&](const Json& other) { return other["photo"] == mark["photo"]; });
  if (same != marks.end()) {
    *same = std::move(mark);
  } else {
    marks.push_back(std::move(mark));
  }
}

}  // namespace

std::string GcpListText(const Json& gcp, const MarkablePhotos& photos) {
  std::string text = gcp["crs"].is_string() ? gcp["crs"].get<std::string>() : "LOCAL";
  text += "\n";
  std::set<std::string> names;
  for (const Json& point : gcp["points"]) {
    const std::string plain = WithoutBlanks(point["name"]);
    std::string name = plain;
    for (int number = 2; !names.insert(name).second; ++number) name = plain + "_" + std::to_string(number);
    std::string place;
    for (const char* axis : {"x", "y", "z"}) place.append(Fixed(point[axis].get<double>(), 4)).append(" ");
    if (point["marks"].empty()) text.append("# no marks yet: ").append(place).append(name).append("\n");
    for (const Json& mark : point["marks"]) {
      const std::string photo = photos.ShortName(mark["photo"]);
      if (std::any_of(photo.begin(), photo.end(), IsBlank)) text += "# a photo with blanks in its name: ";
      text += place;
      for (const Json& pixel : mark["pixel"]) text.append(Fixed(pixel.get<double>() - kMiddle, 2)).append(" ");
      text.append(photo).append(" ").append(name).append("\n");
    }
  }
  return text;
}

Json ReadGcpList(const std::filesystem::path& file, const std::string& text, const std::optional<geo::UtmZone>& zone, const MarkablePhotos& photos) {
  if (text.size() > kMaxListBytes) throw base::InputError(file, "is larger than 4 MiB", "Give only the lines of this project");
  prepare::tables::TextTable table = prepare::tables::ParseTextTable(file, text);
  const bool local = TakeLocalLine(table);
  if (!local && table.crs.empty()) {
    throw base::InputError(file, "does not begin with a coordinate system", "Write it in the first line, for instance EPSG:32632");
  }
  if (local && zone) throw base::InputError(file, "has local coordinates, but the project has a geo-reference", "Give coordinates of a known system");
  if (!local && !zone) throw base::InputError(file, "cannot be converted, as the project has no geo-reference", "Give local metres, and LOCAL first");
  const control::GcpList list = control::ReadGcpList(table, photos.finder());
  const std::vector<control::RawPoint>& points = list.control.points;
  if (points.size() > kMaxControlPoints)
    throw base::InputError(file, "has more than " + std::to_string(kMaxControlPoints) + " points", "Leave some out");
  const MapPlaces map = PlacesOf(list.control, zone);

  std::map<std::string, size_t> index;  // of labels in points
  for (size_t i = 0; i < points.size(); ++i) index[points[i].label] = i;
  std::map<size_t, Json> used;  // by that index
  std::map<int, std::string> left_out;
  for (const control::LineProblem& problem : list.problems) left_out[problem.line] = problem.found;
  for (const control::RawMark& mark : list.control.marks) {
    const size_t i = index.at(mark.label);
    const std::string photo = photos.Find(mark.photo);
    const Eigen::Vector2d pixel = mark.pixel.array() + kMiddle;
    const bool outside = !photo.empty() && !photos.Contains(photo, pixel.x(), pixel.y());
    if (outside || !map.problems[i].empty()) {
      left_out[mark.line] = outside ? "the mark of " + mark.label + " is outside " + photo : map.problems[i];
      continue;
    }
    Json& point = used[i];
    if (point.is_null()) {
      const Eigen::Vector3d& place = map.places[i];
      point = {{"name", points[i].named ? points[i].label : ""}, {"x", place.x()}, {"y", place.y()}, {"z", place.z()}, {"marks", Json::array()}};
    }
    Json json = {{"photo", photo.empty() ? mark.photo : photo}, {"pixel", {pixel.x(), pixel.y()}}};
    if (photo.empty()) json["unknown"] = true;
    SetMark(std::move(json), point["marks"]);
  }

  const auto crs = CrsNameOf(zone.has_value(), zone.value_or(geo::UtmZone()));
  Json gcp = {{"crs", crs ? Json(*crs) : Json(nullptr)}, {"points", Json::array()}};
  for (auto& [i, point] : used) gcp["points"].push_back(std::move(point));
  Json remarks = map.warnings;
  for (const auto& [line, problem] : left_out) {
    if (remarks.size() < kMaxRemarks) remarks.push_back("line " + std::to_string(line) + ": " + problem);
  }
  if (!left_out.empty()) gcp["skipped"] = left_out.size();
  if (!remarks.empty()) gcp["remarks"] = std::move(remarks);
  return gcp;
}

}  // namespace skyquilt::viewer
