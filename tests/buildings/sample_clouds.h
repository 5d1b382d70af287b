// Points on made buildings, the ground around them and trees, as a surface would have them, with what each of them is. Add ../sample_clouds.cpp and
// ../sample_buildings.cpp to the sources of a test and link core_base.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "buildings/building.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

enum class MadeSurface : uint8_t { kGround, kRoof, kWall, kTree };
struct MadeCloud {
  PointCloud cloud;
  std::vector<MadeSurface> surface;  // of each point
  std::vector<int> building;         // id; 0 for ground and trees
};

struct CloudPlan {
  double spacing_m = 0.28;
  double noise_m = 0.0;          // standard deviation along the normal
  double normal_noise = 0.0;     // standard deviation of each component of a normal, before it gets length 1
  double wall_share = 1.0;       // of the points of walls that were seen
  double ground_margin_m = 6.0;  // of the ground around all buildings, level at the first one's ground_z
  uint64_t seed = 1;
};
// Roofs with their overhangs, walls up to the roof, and the ground outside the footprints. Grey ground, red roofs, white walls. Same arguments, same
// cloud.
MadeCloud MadeCloudOf(const std::vector<Building>& buildings, const CloudPlan& plan = {});
// A crown of points around `middle` (ENU) with scattered normals, green or bare.
void AddTree(MadeCloud* made, const Eigen::Vector3d& middle, double radius_m, bool green = true, uint64_t seed = 2);

// Level ground at this height over a square. Needs buildings_points.
inline GroundGrid LevelGround(const Eigen::Vector2d& middle, double half_m, double z, double cell_m = 1.0) {
  const int n = static_cast<int>(2.0 * half_m / cell_m) + 1;
  return {middle - Eigen::Vector2d::Constant(half_m), cell_m, n, n,
          std::vector<float>(static_cast<size_t>(n) * static_cast<size_t>(n), static_cast<float>(z))};
}

}  // namespace skyquilt::buildings
