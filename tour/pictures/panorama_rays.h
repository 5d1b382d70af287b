// Rays of an equirectangular panorama: all directions about an eye. North is in the middle, east to the right of it, south at both ends; the top row
// looks up, the bottom row down. Along a row the azimuth grows evenly, along a column the elevation falls evenly.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "core/render/ray.h"

namespace skyquilt::tour {

class PanoramaRays {
 public:
  // width: even; a panorama is half as high as it is wide.
  PanoramaRays(const Eigen::Vector3d& eye_enu, int width);

  // Through the centres of pixels, row * width + column each; `out` has the same length. Thread-safe.
  // All are cones as wide as a row is high, which is a pixel's own angle at the horizon. Towards the poles pixels become narrower and never lower.
  // Narrower cones would show no more there, since the rows are as far apart as everywhere, but they would alias from row to row, and ask the field
  // for detail finer than it was trained on.
  void Make(std::span<const size_t> pixels, std::span<render::Ray> out) const;

 private:
  Eigen::Vector3d eye_enu_;
  float pitch_;
  std::vector<Eigen::Vector2d> across_;  // per column: east and north of a level direction
  std::vector<Eigen::Vector2d> up_;      // per row: cosine and sine of the elevation
};

// The pixels of all tiles (core/scene/camera_rays.h), one column of tiles after the other. Rays that are rendered together then look in similar
// directions and need few blocks, which matters when the fields do not all fit in memory.
std::vector<size_t> PanoramaOrder(int width);

}  // namespace skyquilt::tour
