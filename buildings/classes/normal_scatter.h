// How much the normals of points scatter: leaves look in all directions, roofs and walls do not.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

// For each chosen point (indices into the cloud) the least eigenvalue of the mean of n n^T over the chosen points near it, of which there must be
// four, else 0. It is 0 on a plane and at an edge of two planes, 1/3 for normals of all directions. The sign of normals does not count. Near are the
// cell of 1 m that holds the point and those that touch it, so that all points of a cell have one value. Same bits for any number of threads. Throws
// base::Interrupted.
std::vector<float> NormalScatter(const PointCloud& cloud, std::span<const uint32_t> chosen, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
