// Each point's nearest neighbours and the plane through them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

inline constexpr size_t kMostNeighbours = 15;

struct Neighbourhood {
  std::array<uint32_t, kMostNeighbours> near;  // places in `chosen`, the nearest first, without the point itself
  uint32_t n = 0;
  Eigen::Vector3f normal;  // of the plane through the point and them, on the side of the point's own normal
  float roughness = 1.0F;  // see FittedPlane; 1 when there are too few neighbours for a plane, then the normal is the point's own

  std::span<const uint32_t> Near() const { return {near.data(), n}; }
};

// One for each chosen point. Throws base::Interrupted.
std::vector<Neighbourhood> FindNeighbourhoods(const PointCloud& cloud, std::span<const uint32_t> chosen, double reach_m, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
