// Improves a rendered picture of depth by the photo that was taken there and its neighbours: around the rendered depth, planes are searched under
// which the photos agree best (PatchMatch stereo: Bleyer et al. 2011; Galliani et al. 2015).
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/kernel/match.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// A photo that shows the same places.
struct RefineSource {
  const kernel::MatchPicture* picture = nullptr;
  ViewPose pose;
};

struct RefineOptions {
  double range_px = 8.0;  // search range around the rendered depth, in pixels of disparity in a typical neighbour
  double prior = 0.001;   // correlation that a pixel of disparity away from the rendered depth costs, growing with the square
  int iterations = 6;
};

// Length of the ray through a pixel's middle to depth 1 along the optical axis.
inline double LengthAt(const ViewPose& pose, int x, int y) {
  const double u = (x + 0.5 - pose.cx) / pose.focal_px, v = (y + 0.5 - pose.cy) / pose.focal_px;
  return std::sqrt(1.0 + u * u + v * v);
}

// Per pixel: inverse depth along the optical axis, its slopes per pixel to the right and down, and the correlation with the neighbours;
// kernel::kNoMatch where there is no depth.
struct RefinedDepth {
  std::vector<float> inverse_depth, slope_x, slope_y, correlation;

  // Of the angle between the ray of a pixel and the normal of its plane.
  double CosineAt(const ViewPose& pose, int x, int y) const;
};

// depth_m: as DepthView. Same bits for any number of threads. Throws base::Interrupted.
RefinedDepth RefineDepth(const ViewPose& pose, std::span<const float> depth_m, const kernel::MatchPicture& own, std::span<const RefineSource> sources,
                         const RefineOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
