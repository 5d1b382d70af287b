// A building of a simulated place. Its sizes are known exactly, so that heights measured in a reconstruction can be checked against them.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulate/mesh.h"

namespace skyquilt::simulate {

enum class BuildingKind { kHouse, kShed, kApartment, kTower, kHall };
enum class RoofKind { kFlat, kGable, kHip };
const char* KindName(BuildingKind kind);
const char* RoofName(RoofKind roof);

struct Building {
  BuildingKind kind = BuildingKind::kHouse;
  RoofKind roof = RoofKind::kGable;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  // ENU metres
  double yaw_deg = 0.0;                              // of the length axis, counter-clockwise from east
  double length_m = 10.0;                            // between the outer walls
  double width_m = 8.0;                              // <= length_m
  double eave_height_m = 5.0;                        // top of the long walls (flat roof: the roof deck), above ground_z_m
  double ridge_height_m = 8.0;                       // above ground_z_m; flat roof: the eave height
  double parapet_height_m = 0.0;                     // above a flat roof's deck
  double ground_z_m = 0.0;                           // ENU height of the ground at the centre
  double foundation_m = 1.5;                         // the walls begin this far below ground_z_m
  uint32_t seed = 0;

  // Unit vector of the length axis, east and north.
  Eigen::Vector2d Axis() const;
  // A point in the building's own axes, metres: x along the length, y along the width, z above ground_z_m.
  Eigen::Vector3f Local(const Eigen::Vector3f& x_in_enu) const { return Local(x_in_enu, Axis().cast<float>()); }
  // The same for a caller that already has Axis().
  Eigen::Vector3f Local(const Eigen::Vector3f& x_in_enu, const Eigen::Vector2f& axis) const;
  // Horizontal distance of a point (east, north) to the walls, metres; negative inside.
  double DistanceTo(const Eigen::Vector2d& point) const;
};

// Adds the building's triangles, tagged with `index`. The walls' foundation leaves no gap on slopes.
void AddBuilding(const Building& building, uint32_t index, Mesh& mesh);

}  // namespace skyquilt::simulate
