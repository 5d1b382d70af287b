// A tree of a simulated place: a trunk and a few irregular crowns.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

inline constexpr double kCrownReach = 1.35;  // crowns reach no farther than this many radii

struct Tree {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // ENU metres
  double ground_z_m = 0.0;
  double height_m = 7.0;
  double crown_radius_m = 2.5;
  bool conifer = false;
  uint32_t seed = 0;
};

// Adds the tree's triangles, tagged with `index`. detail: subdivisions of each crown's sphere, 0..3.
void AddTree(const Tree& tree, uint32_t index, int detail, Mesh& mesh);

}  // namespace skyquilt::simulate
