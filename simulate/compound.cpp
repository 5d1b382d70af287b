#include "simulate/compound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::simulate {

using Eigen::Vector2d;

namespace {

constexpr double kSmallDeckLength_m = 16.0, kSmallDeckWidth_m = 6.0;  // machines on smaller decks would stick out

// Half the extent along x and y of a part whose sides are along them.
Vector2d HalfAround(const Building& part) {
  const Vector2d u = part.Axis().cwiseAbs();
  return 0.5 * (part.length_m * u + part.width_m * Vector2d(u.y(), u.x()));
}

void Join(BuildingShape shape, std::vector<Building>& parts) {
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Building& part : parts) {
    low = low.cwiseMin(part.centre - HalfAround(part));
    high = high.cwiseMax(part.centre + HalfAround(part));
  }
  for (size_t i = 0; i < parts.size(); ++i) {
    parts[i].centre -= 0.5 * (low + high);
    parts[i].shape = shape;
    parts[i].joined = i > 0;
    if (parts[i].roof == RoofKind::kFlat && (parts[i].length_m < kSmallDeckLength_m || parts[i].width_m < kSmallDeckWidth_m))
      parts[i].bare_roof = true;
  }
}

}  // namespace

void MoveParts(const PlaneTurn& turn, const Vector2d& place, std::vector<Building>& parts) {
  for (Building& part : parts) {
    part.centre = place + turn.TurnedDirection(part.centre);
    part.yaw_deg = turn.TurnedYaw(part.yaw_deg);
  }
}

Vector2d SizeAround(std::span<const Building> parts) {
  Vector2d half = Vector2d::Zero();
  for (const Building& part : parts) half = half.cwiseMax(part.centre.cwiseAbs() + HalfAround(part));
  return 2.0 * half;
}

std::vector<Building> WithWing(const Building& main, const Wing& wing, BuildingShape shape) {
  Building added = main;
  added.length_m = wing.length_m;
  added.width_m = wing.width_m;
  added.eave_height_m = wing.eave_height_m;
  added.ridge_height_m = wing.eave_height_m + 0.5 * wing.width_m * main.RoofRise();
  added.yaw_deg = main.yaw_deg + 90.0;
  const Vector2d u = main.Axis(), v(-u.y(), u.x());
  added.centre = main.centre + wing.along_m * u + 0.5 * (main.width_m + wing.length_m) * v;
  added.shared[2] = true;
  added.bare_roof = true;
  if (main.roof != RoofKind::kFlat) {
    added.roof = RoofKind::kGable;
    added.onto_eave_height_m = main.eave_height_m;
    added.onto_rise = main.RoofRise();
  }
  std::vector<Building> parts = {main, added};
  Join(shape, parts);
  return parts;
}

std::vector<Building> WithSetback(const Building& podium, const Vector2d& size, const Vector2d& offset, double height_m) {
  Building upper = podium;
  upper.length_m = size.maxCoeff();
  upper.width_m = size.minCoeff();
  upper.yaw_deg = podium.yaw_deg + (size.x() < size.y() ? 90.0 : 0.0);
  upper.centre = podium.centre + PlaneTurn({0.0, 0.0}, podium.yaw_deg).TurnedDirection(offset);
  upper.base_height_m = podium.eave_height_m;
  upper.eave_height_m = upper.ridge_height_m = height_m;
  std::vector<Building> parts = {podium, upper};
  // Machines would stand where the upper part does.
  parts[0].bare_roof = true;
  Join(BuildingShape::kSetback, parts);
  return parts;
}

std::vector<Building> Row(std::vector<Building> houses) {
  double x = 0.0;
  for (size_t i = 0; i < houses.size(); ++i) {
    Building& house = houses[i];
    house.yaw_deg = 0.0;
    house.centre = {x + 0.5 * house.length_m, 0.5 * house.width_m};
    x += house.length_m;
    // A flat roof keeps its parapet along the neighbour's roof.
    if (house.roof == RoofKind::kFlat) continue;
    house.shared[2] = i > 0;
    house.shared[0] = i + 1 < houses.size();
  }
  Join(BuildingShape::kRow, houses);
  return houses;
}

std::vector<Building> Courtyard(const Building& like, const Vector2d& size, double depth_m, const std::array<double, 4>& heights_m) {
  std::vector<Building> wings(4, like);
  const Vector2d middle = 0.5 * (size - Vector2d::Constant(depth_m));
  const std::array<Vector2d, 4> centre = {Vector2d(0.0, -middle.y()), Vector2d(middle.x(), 0.0), Vector2d(0.0, middle.y()),
                                          Vector2d(-middle.x(), 0.0)};
  for (size_t i = 0; i < wings.size(); ++i) {
    Building& wing = wings[i];
    const bool between = i % 2 == 1;
    wing.length_m = between ? size.y() - 2.0 * depth_m : size.x();
    wing.width_m = depth_m;
    wing.yaw_deg = between ? 90.0 : 0.0;
    wing.centre = centre[i];
    wing.roof = RoofKind::kFlat;
    wing.eave_height_m = wing.ridge_height_m = heights_m[i];
    // Between decks of the same height only the longer wing has a parapet.
    if (between) wing.shared = {heights_m[i] == heights_m[2], false, heights_m[i] == heights_m[0], false};
  }
  Join(BuildingShape::kCourtyard, wings);
  return wings;
}

}  // namespace skyquilt::simulate
