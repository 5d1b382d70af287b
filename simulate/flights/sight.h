// What a camera sees and where one can be, in the static scene of a simulated place.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "simulate/outline.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

struct Sighting {
  double distance_m = 0.0;
  Tag tag;
};

// The first surface from `from` (ENU metres) in a direction of length 1; nothing in the sky.
std::optional<Sighting> LookAlong(const World& world, const Eigen::Vector3d& from, const Eigen::Vector3d& direction);
// Whether the first surface towards a point in or on this building is the building's.
bool SeesBuilding(const World& world, const Eigen::Vector3d& from, const Eigen::Vector3d& at, const Outline& building);
// Whether a camera can be there: above the ground, outside all that is solid and outside the crowns of trees, and farther than clearance_m from all.
bool IsFree(const World& world, const Eigen::Vector3d& at, double clearance_m);

}  // namespace skyquilt::simulate
