// Points spread evenly over a surface.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace skyquilt::evaluate::surface {

struct SurfaceSample {
  Eigen::Vector3f point;  // in the frame of the surface's positions
  uint32_t triangle = 0;
};

// One point per `area_m2` of the triangles that are used, at most max_samples, then fewer per area: the total area is cut into pieces of the same
// size, each with a random point. The same points for the same surface.
std::vector<SurfaceSample> SampleSurface(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle,
                                         const std::function<bool(uint32_t)>& is_used, double area_m2, int64_t max_samples);

}  // namespace skyquilt::evaluate::surface
