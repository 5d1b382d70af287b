#include "buildings/files/building_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geo/utm.h"

namespace skyquilt::buildings {
namespace {

constexpr int kLengthDigits = 4, kAngleDigits = 4, kShareDigits = 4, kDegreeDigits = 9;

// ENU; the origin for a building without a footprint.
Eigen::Vector2d PlaceOf(const Building& building) {
  return building.footprint.outer.size() < 3 ? Eigen::Vector2d::Zero() : Centroid(building.footprint);
}

Measure RoundedMeasure(const Measure& measure, int digits) {
  return {.value = Rounded(measure.value, digits), .sigma = Rounded(measure.sigma, digits)};
}

gis::FieldValue RealOf(double value) {
  return std::isfinite(value) ? gis::FieldValue(value) : gis::FieldValue();
}

}  // namespace

std::vector<NamedMeasure> MeasuresOf(const Building& building, const FileFrame& frame) {
  const Measures& known = building.measures;
  const Eigen::Vector2d place = PlaceOf(building);
  // Measures are lengths by the scale bar already, the place of the ground is one of the survey.
  const auto map_height = [&](const Measure& height) {
    if (!std::isfinite(height.value)) return height.value;
    if (!std::isfinite(known.ground_m.value)) return frame.HeightOf(place, height.value / frame.scale());
    return frame.HeightOf(place, known.ground_m.value / frame.scale()) + (height.value - known.ground_m.value);
  };
  const auto unit = [&](const char* name, const char* of_metres) { return std::string(name) + (frame.metric() ? of_metres : ""); };
  std::vector<NamedMeasure> measures;
  const auto add = [&](std::string name, const Measure& measure, int digits) {
    measures.push_back({.name = std::move(name), .measure = RoundedMeasure(measure, digits)});
  };
  add(unit("ground", "_m"), {map_height(known.ground_m), known.ground_m.sigma}, kLengthDigits);
  add(unit("eave", "_m"), {map_height(known.eave_m), known.eave_m.sigma}, kLengthDigits);
  add(unit("ridge", "_m"), {map_height(known.ridge_m), known.ridge_m.sigma}, kLengthDigits);
  add(unit("height", "_m"), known.height_m, kLengthDigits);
  add(unit("length", "_m"), known.length_m, kLengthDigits);
  add(unit("width", "_m"), known.width_m, kLengthDigits);
  add("yaw_deg", known.yaw_deg, kAngleDigits);
  add(unit("area", "_m2"), known.footprint_m2, kLengthDigits);
  add(unit("volume", "_m3"), known.volume_m3, kLengthDigits);
  add(unit("roof_area", "_m2"), known.roof_m2, kLengthDigits);
  add("pitch_deg", known.pitch_deg, kAngleDigits);
  return measures;
}

BuildingTable TableOf(const BuildingSet& set, const FileFrame& frame) {
  BuildingTable table;
  const auto real = [&](const std::string& name) { table.fields.push_back({name, gis::FieldType::kReal}); };
  table.fields.push_back({"id", gis::FieldType::kInteger});
  for (const char* name : {"longitude", "latitude", "easting", "northing"}) real(name);
  for (const NamedMeasure& column : MeasuresOf(Building{}, frame)) {
    real(column.name);
    real(column.name + "_sigma");
  }
  real("wall_seen");
  table.fields.push_back({"roof", gis::FieldType::kText});
  table.fields.push_back({"accepted", gis::FieldType::kInteger});
  table.fields.push_back({"note", gis::FieldType::kText});
  const bool given = std::any_of(set.buildings.begin(), set.buildings.end(), [](const Building& building) { return building.given; });
  if (given) table.fields.push_back({"outline_id", gis::FieldType::kText});

  for (const Building& building : set.buildings) {
    std::vector<gis::FieldValue>& row = table.rows.emplace_back();
    row.emplace_back(int64_t{building.id});
    const double z = std::isfinite(building.shape.ground_z) ? building.shape.ground_z : 0.0;
    const Eigen::Vector2d place = PlaceOf(building);
    const Eigen::Vector3d position = frame.PositionOf({place.x(), place.y(), z});
    if (frame.map().georeferenced() && frame.metric()) {
      const geo::Geodetic geodetic = geo::GeodeticFromUtm(position.head<2>(), position.z(), frame.map().zone());
      row.push_back(RealOf(Rounded(geodetic.longitude_deg, kDegreeDigits)));
      row.push_back(RealOf(Rounded(geodetic.latitude_deg, kDegreeDigits)));
    } else {
      row.resize(row.size() + 2);
    }
    row.push_back(RealOf(position.x()));
    row.push_back(RealOf(position.y()));
    for (const NamedMeasure& column : MeasuresOf(building, frame)) {
      row.push_back(RealOf(column.measure.value));
      row.push_back(RealOf(column.measure.sigma));
    }
    row.push_back(RealOf(Rounded(building.measures.wall_seen, kShareDigits)));
    row.emplace_back(std::string(NameOf(building.roof)));
    row.emplace_back(int64_t{building.accepted ? 1 : 0});
    row.emplace_back(building.note);
    if (given) row.emplace_back(building.given_id);
  }
  return table;
}

}  // namespace skyquilt::buildings
