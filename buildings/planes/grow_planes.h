// Planar pieces of a point cloud by region growing on point normals (the scheme of roofer; Rabbani et al. 2006).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

struct PlaneOptions {
  double distance_m = 0.3;  // of a point from its plane
  double angle_deg = 25.0;  // between its normal and the plane's
  double reach_m = 0.6;     // neighbours
  int min_points = 15;
  double min_area_m2 = 2.0;
};

struct RoofPlane {
  std::vector<uint32_t> points;  // indices into the cloud
  Eigen::Vector3d middle;        // ENU, mean of the points
  Eigen::Vector3d normal;        // length 1, out of the surface
  double rms_m = 0.0;            // distance of its points
  double area_m2 = 0.0;          // points times spacing^2
};

// Planes of the chosen points (indices into the cloud), largest first; each point belongs to at most one. Deterministic for any number of threads:
// seeds in the order of falling planarity of their neighbourhood, ties by index. Throws base::Interrupted.
std::vector<RoofPlane> GrowPlanes(const PointCloud& cloud, std::span<const uint32_t> chosen, const PlaneOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::buildings
