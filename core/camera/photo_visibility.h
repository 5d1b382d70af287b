// Tests whether a photo shows a place, to count how many photos see it. Occlusion is ignored: a roof hides nothing.
// Callers use different rules (partition/visibility does not use this; it intersects rays with boxes):
//   partition/survey_area  ground covered by photos: centres of raster cells up to a maximum distance, because far oblique views show little detail.
//                          All edges of the frame count as inside. Masks are not used.
//   worker/start/view_count places that can be learned: balls around groups of cells, because a photo that shows only a part of a group helps too.
//                          A ball around or next to the camera counts in any direction. No maximum distance, no masks.
//   evaluate/photos        pixels that are scored: surface points that a training photo shows on an unmasked pixel. No maximum distance.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>

#include "core/camera/camera.h"
#include "core/geo/transform.h"

namespace skyquilt::camera {

struct VisibilityRule {
  double radius_m = 0.0;                                     // the frame must touch a ball of this radius around the place; 0: contain the place
  double reach_m = std::numeric_limits<double>::infinity();  // largest distance from the camera
  bool far_edges = false;                                    // whether the right and lower edges count as inside; the others always do
  std::span<const uint8_t> mask = {};                        // width * height of the camera, 0 = ignored pixel; empty: no mask
};

// Place and pose in the same frame, metres. A ball that intersects the camera plane counts when its centre is nearer to the camera than four radii.
// For a ball, the mask pixel nearest to its centre is used. False for places that are not finite.
bool IsVisible(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x_in_enu, const VisibilityRule& rule = {});

}  // namespace skyquilt::camera
