// Closes holes of a mesh whose borders were found.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "surface/mesh/hole_patch.h"
#include "surface/mesh/mesh_tools.h"

namespace skyquilt::surface {

struct Hole {
  std::vector<uint32_t> vertex;           // counter-clockwise seen from the free space
  std::vector<Eigen::Vector3d> position;  // of these vertices, turned
  // Turns what is outside of the surface upwards. Nothing: it is as it is, so that no bit of a position changes.
  std::optional<Eigen::Matrix3d> turn;
  Eigen::Vector3d low, high;  // box, not turned, outside of which nothing can block the hole
  // Nor what is lower or higher than this when turned.
  double lowest_m = -std::numeric_limits<double>::infinity(), highest_m = std::numeric_limits<double>::infinity();
  bool blocked = false;  // something of the mesh lies inside

  Eigen::Vector3d Turned(const Eigen::Vector3d& x) const { return turn ? Eigen::Vector3d(*turn * x) : x; }
  Eigen::Vector3d TurnedBack(const Eigen::Vector3d& x) const { return turn ? Eigen::Vector3d(turn->transpose() * x) : x; }
  Eigen::Vector3d Normal() const { return TurnedBack(Eigen::Vector3d::UnitZ()); }
};

// Closes those that are not blocked, that the patch fits, and in which no new vertex is open (null: none is). `uses`: of the mesh before. Returns the
// area that was closed, square metres.
double CloseHoles(std::vector<Hole> holes, const std::vector<EdgeUse>& uses, double spacing_m, const IsOpenThere& is_open, Mesh* mesh);

}  // namespace skyquilt::surface
