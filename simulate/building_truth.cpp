#include "simulate/building_truth.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "simulate/outline.h"

namespace skyquilt::simulate {
namespace {

using TruthJson = nlohmann::ordered_json;

constexpr const char* kAboutBuildings =
    "ENU metres about the survey's origin. buildings: rectangular parts; heights above ground_z_m (ground at the middle of the outline); yaw of the "
    "length axis counter-clockwise from east; flat roofs: eave = ridge = roof deck, the parapet is above it; base_z_m: where the walls begin, ground "
    "or the deck below; carries: parts that stand on this deck; inside_area: of the centre. outlines: the walls of all parts together, those of "
    "houses that share a wall too; walls and roof_outline counter-clockwise, holes clockwise; length and width of the rectangle around the walls; "
    "kind, roof and eave of the largest part, ridge of the highest; planes: of the roofs, normal . x = offset; inside_area: of all walls";

bool IsInside(const PlaceSpec& place, const Eigen::Vector2d& at) {
  return (at - place.area_min).minCoeff() >= 0.0 && (place.area_max - at).minCoeff() >= 0.0;
}

TruthJson PointJson(const Eigen::Vector2d& point) {
  return {point.x(), point.y()};
}

TruthJson RingJson(const Ring& ring) {
  TruthJson json = TruthJson::array();
  for (const Eigen::Vector2d& point : ring) json.push_back(PointJson(point));
  return json;
}

TruthJson PartJson(const std::vector<Building>& buildings, const Outline& outline, size_t row, const PlaceSpec& place, const geo::EnuFrame& frame) {
  const Building& b = buildings[row];
  const geo::Geodetic at = frame.GeodeticFromEnu({b.centre.x(), b.centre.y(), b.ground_z_m});
  TruthJson carries = TruthJson::array();
  for (size_t i = outline.first; i < outline.first + outline.n_parts; ++i) {
    const bool on_deck = i != row && buildings[i].base_height_m > 0.0 && buildings[i].base_height_m == b.eave_height_m;
    if (on_deck && b.DistanceTo(buildings[i].centre) < 0.0) carries.push_back(i);
  }
  return {{"id", row},
          {"kind", KindName(b.kind)},
          {"roof", RoofName(b.roof)},
          {"longitude_deg", at.longitude_deg},
          {"latitude_deg", at.latitude_deg},
          {"east_m", b.centre.x()},
          {"north_m", b.centre.y()},
          {"ground_z_m", b.ground_z_m},
          {"length_m", b.length_m},
          {"width_m", b.width_m},
          {"eave_height_m", b.eave_height_m},
          {"ridge_height_m", b.ridge_height_m},
          {"parapet_height_m", b.parapet_height_m},
          {"yaw_deg", b.yaw_deg},
          {"inside_area", IsInside(place, b.centre)},
          {"building", b.outline},
          {"roof_overhang_m", b.RoofOverhang()},
          {"base_z_m", b.ground_z_m + b.base_height_m},
          {"carries", carries}};
}

TruthJson OutlineJson(const std::vector<Building>& buildings, const Outline& outline, const PlaceSpec& place) {
  const Building& largest = buildings[outline.largest];
  TruthJson parts = TruthJson::array(), planes = TruthJson::array(), holes = TruthJson::array();
  double ridge_height_m = 0.0;
  for (size_t row = outline.first; row < outline.first + outline.n_parts; ++row) {
    parts.push_back(row);
    ridge_height_m = std::max(ridge_height_m, buildings[row].ridge_height_m);
    for (const RoofPlane3d& plane : RoofPlanes(buildings[row])) {
      planes.push_back({{"part", row}, {"normal", {plane.normal.x(), plane.normal.y(), plane.normal.z()}}, {"offset", plane.offset}});
    }
  }
  for (const Ring& hole : outline.holes) holes.push_back(RingJson(hole));
  const bool inside = std::all_of(outline.walls.begin(), outline.walls.end(), [&](const Eigen::Vector2d& at) { return IsInside(place, at); });
  return {{"id", largest.outline},
          {"shape", ShapeName(largest.shape)},
          {"kind", KindName(largest.kind)},
          {"roof", RoofName(largest.roof)},
          {"parts", parts},
          {"walls", RingJson(outline.walls)},
          {"holes", holes},
          {"roof_outline", RingJson(outline.roof)},
          {"centre", PointJson(outline.centre)},
          {"length_m", outline.length_m},
          {"width_m", outline.width_m},
          {"yaw_deg", outline.yaw_deg},
          {"ground_z_m", largest.ground_z_m},
          {"eave_height_m", largest.eave_height_m},
          {"ridge_height_m", ridge_height_m},
          {"area_m2", outline.area_m2},
          {"planes", planes},
          {"inside_area", inside}};
}

}  // namespace

void WriteBuildingTruth(const std::filesystem::path& folder, const std::vector<Building>& buildings, const PlaceSpec& place,
                        const geo::EnuFrame& frame) {
  TruthJson parts = TruthJson::array(), outlines = TruthJson::array();
  for (const Outline& outline : FindOutlines(buildings)) {
    for (size_t row = outline.first; row < outline.first + outline.n_parts; ++row) parts.push_back(PartJson(buildings, outline, row, place, frame));
    outlines.push_back(OutlineJson(buildings, outline, place));
  }
  const TruthJson json = {{"about", kAboutBuildings}, {"buildings", parts}, {"outlines", outlines}};
  base::WriteFileAtomically(folder / "truth" / "buildings.json", base::JsonText(json, 1) + "\n");
}

}  // namespace skyquilt::simulate
