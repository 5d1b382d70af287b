// The plane of a face and places in it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// Normal as long as the area (Newell); of clockwise rings it points the other way.
Eigen::Vector3d AreaVector(const Solid& solid, std::span<const uint32_t> ring);
// Holes subtracted.
Eigen::Vector3d AreaVector(const Solid& solid, const Face& face);

// Axes in the plane, so that x, y and the normal are right-handed.
struct FacePlane {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // mean of the vertices
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY();

  Eigen::Vector2d Project(const Eigen::Vector3d& point) const { return {(point - middle).dot(x), (point - middle).dot(y)}; }
  double HeightAbove(const Eigen::Vector3d& point) const { return (point - middle).dot(normal); }
};
// A face without area gets a horizontal plane.
FacePlane PlaneOf(const Solid& solid, const Face& face);

}  // namespace skyquilt::buildings
