#include "evaluate/buildings/true_buildings.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/geo/transform.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::evaluate::buildings {
namespace {

using TruthJson = nlohmann::json;

constexpr const char* kSimulateBuildingsAgain = "Run 'skyquilt simulate' again";
constexpr double kDegreesToRadians = std::numbers::pi / 180.0;
constexpr double kNearlyLargest = 0.9;  // share of the area of the largest part

RoofKind TrueRoof(const std::string& name) {
  for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip}) {
    if (name == NameOf(roof)) return roof;
  }
  return RoofKind::kOther;
}

std::vector<Eigen::Vector2d> RingFrom(const TruthJson& points) {
  std::vector<Eigen::Vector2d> ring;
  for (const TruthJson& point : points) ring.emplace_back(point.at(0).get<double>(), point.at(1).get<double>());
  return ring;
}

double SignedArea(const std::vector<Eigen::Vector2d>& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// Polygons want the outer ring counter-clockwise and holes clockwise.
void Orient(Polygon* polygon) {
  if (SignedArea(polygon->outer) < 0.0) std::reverse(polygon->outer.begin(), polygon->outer.end());
  for (std::vector<Eigen::Vector2d>& hole : polygon->holes) {
    if (SignedArea(hole) > 0.0) std::reverse(hole.begin(), hole.end());
  }
}

// Both forms name sizes, heights and directions alike.
TrueBuilding CommonOf(const TruthJson& one) {
  TrueBuilding building;
  building.id = one.at("id").get<int>();
  building.kind = one.value("kind", "");
  building.roof = TrueRoof(one.at("roof").get<std::string>());
  building.length_m = one.at("length_m").get<double>();
  building.width_m = one.at("width_m").get<double>();
  building.yaw_deg = one.at("yaw_deg").get<double>();
  building.ground_z_m = one.at("ground_z_m").get<double>();
  building.eave_z_m = building.ground_z_m + one.at("eave_height_m").get<double>();
  building.ridge_z_m = building.ground_z_m + one.at("ridge_height_m").get<double>();
  building.inside = one.at("inside_area").get<bool>();
  return building;
}

TrueBuilding OutlineFrom(const TruthJson& outline) {
  TrueBuilding building = CommonOf(outline);
  building.shape = outline.value("shape", "");
  building.walls.outer = RingFrom(outline.at("walls"));
  if (outline.contains("holes")) {
    for (const TruthJson& hole : outline.at("holes")) building.walls.holes.push_back(RingFrom(hole));
  }
  return building;
}

// rows: all parts of the place, of which the outline names its own.
void AddOtherEaves(const TruthJson& outline, const TruthJson& rows, TrueBuilding* building) {
  if (!outline.contains("parts")) return;
  const auto area = [&](const TruthJson& part) {
    const TruthJson& row = rows.at(part.get<size_t>());
    return row.at("length_m").get<double>() * row.at("width_m").get<double>();
  };
  double largest = 0.0;
  for (const TruthJson& part : outline.at("parts")) largest = std::max(largest, area(part));
  for (const TruthJson& part : outline.at("parts")) {
    const TrueBuilding own = CommonOf(rows.at(part.get<size_t>()));
    const bool pitched = own.roof == RoofKind::kGable || own.roof == RoofKind::kHip;
    if (pitched && area(part) >= kNearlyLargest * largest) building->other_eaves_z_m.push_back(own.eave_z_m);
  }
}

// Rows say only whether the centre is inside the surveyed area; the whole rectangle must be, as in outlines.
TrueBuilding RectangleFrom(const TruthJson& row, const std::optional<Polygon>& area) {
  TrueBuilding building = CommonOf(row);
  building.shape = "rectangle";
  const double yaw = building.yaw_deg * kDegreesToRadians;
  const skyquilt::buildings::Rectangle rectangle{{row.at("east_m").get<double>(), row.at("north_m").get<double>()},
                                                 {std::cos(yaw), std::sin(yaw)},
                                                 {0.5 * building.length_m, 0.5 * building.width_m}};
  building.walls = rectangle.Outline();
  if (building.width_m > building.length_m) {
    std::swap(building.length_m, building.width_m);
    building.yaw_deg += 90.0;
  }
  for (const Eigen::Vector2d& corner : building.walls.outer) building.inside &= !area || Contains(*area, corner);
  return building;
}

void MoveRing(const geo::Rigid3d& survey_from_truth, double z_m, std::vector<Eigen::Vector2d>* ring) {
  for (Eigen::Vector2d& point : *ring) point = (survey_from_truth * Eigen::Vector3d(point.x(), point.y(), z_m)).head<2>();
}

void MovePolygon(const geo::Rigid3d& survey_from_truth, double z_m, Polygon* polygon) {
  MoveRing(survey_from_truth, z_m, &polygon->outer);
  for (std::vector<Eigen::Vector2d>& hole : polygon->holes) MoveRing(survey_from_truth, z_m, &hole);
}

void MoveBuilding(const geo::Rigid3d& survey_from_truth, TrueBuilding* building) {
  const Eigen::Vector2d middle = Centroid(building->walls);
  const double rise = (survey_from_truth * Eigen::Vector3d(middle.x(), middle.y(), building->ground_z_m)).z() - building->ground_z_m;
  MovePolygon(survey_from_truth, building->ground_z_m, &building->walls);
  for (double* z : {&building->ground_z_m, &building->eave_z_m, &building->ridge_z_m}) *z += rise;
  for (double& z : building->other_eaves_z_m) z += rise;
  const double yaw = building->yaw_deg * kDegreesToRadians;
  const Eigen::Vector3d axis = survey_from_truth.rotation * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0);
  building->yaw_deg = std::atan2(axis.y(), axis.x()) / kDegreesToRadians;
}

// In the simulator's frame.
std::optional<Polygon> SurveyedArea(const std::filesystem::path& simulate_json) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(simulate_json, ignored)) return std::nullopt;
  const TruthJson simulated = TruthJson::parse(base::ReadFile(simulate_json));
  if (!simulated.contains("blocks")) return std::nullopt;
  const TruthJson& blocks = simulated.at("blocks");
  if (!blocks.contains("min_enu") || !blocks.contains("max_enu")) return std::nullopt;
  const std::vector<Eigen::Vector2d> corners = RingFrom({blocks.at("min_enu"), blocks.at("max_enu")});
  const Eigen::Vector2d &low = corners[0], &high = corners[1];
  return Polygon{{low, {high.x(), low.y()}, high, {low.x(), high.y()}}, {}};
}

bool IsUsable(const TrueBuilding& building) {
  bool finite = building.walls.outer.size() >= 3;
  for (const Eigen::Vector2d& point : building.walls.outer) finite &= point.allFinite();
  for (const double value : {building.ground_z_m, building.eave_z_m, building.ridge_z_m, building.length_m, building.width_m, building.yaw_deg}) {
    finite &= std::isfinite(value);
  }
  return finite && SignedArea(building.walls.outer) != 0.0;
}

}  // namespace

TrueBuildings ReadTrueBuildings(const std::filesystem::path& buildings_json, const geo::Geodetic& survey_origin) {
  const std::filesystem::path simulate_json = buildings_json.parent_path().parent_path() / "simulate.json";
  const geo::Rigid3d survey_from_truth = surface::SurveyFromTruth(simulate_json, survey_origin);
  TrueBuildings truth;
  try {
    truth.area = SurveyedArea(simulate_json);
    const TruthJson content = TruthJson::parse(base::ReadFile(buildings_json));
    if (content.contains("outlines")) {
      for (const TruthJson& outline : content.at("outlines")) {
        truth.outlines.push_back(OutlineFrom(outline));
        AddOtherEaves(outline, content.at("buildings"), &truth.outlines.back());
      }
    } else {
      for (const TruthJson& row : content.at("buildings")) truth.outlines.push_back(RectangleFrom(row, truth.area));
    }
  } catch (const TruthJson::exception& error) {
    throw base::InputError(buildings_json, std::string("or simulate.json beside its folder is damaged (") + error.what() + ")",
                           kSimulateBuildingsAgain);
  }
  for (TrueBuilding& building : truth.outlines) {
    if (!IsUsable(building)) {
      throw base::InputError(buildings_json, "is damaged: building " + std::to_string(building.id) + " has no walls, or a figure is not a number",
                             kSimulateBuildingsAgain);
    }
    Orient(&building.walls);
    MoveBuilding(survey_from_truth, &building);
    building.area_m2 = Area(building.walls);
  }
  if (truth.area) MovePolygon(survey_from_truth, 0.0, &*truth.area);
  return truth;
}

}  // namespace skyquilt::evaluate::buildings
