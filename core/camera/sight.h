// Whether a photo shows a place: what every count of "how many photos see this place" builds on (partition/visibility counts
// rays that meet a box instead). Who counts asks for different things on purpose:
//   partition/survey_area  which ground is covered: middles of raster cells, and not from far away, where oblique views blur into the horizon.
//                          A place on any edge of the frame counts. Masks are not read yet.
//   worker/view_count      what could be learned: balls around groups of cells, since a photo that shows but the rim of a group still teaches it.
//                          A ball that the camera stands in or next to counts wherever it looks. No limit of distance, no masks.
//   evaluate/coverage      which pixels may be scored: points of the surface, which must have been trained on and so lie on unmasked pixels.
//                          No limit of distance; places outside the cone of the frame are turned away before.
// Occlusion is nobody's question here: a roof hides nothing.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>

#include "core/camera/camera.h"
#include "core/geo/transform.h"

namespace skyquilt::camera {

struct SightRule {
  double radius_m = 0.0;                                     // of the ball around the place that the frame has to touch; 0: the place itself
  double reach_m = std::numeric_limits<double>::infinity();  // the place may be no farther from the camera
  bool far_edges = false;                                    // whether the frame's right and lower edges belong to it, as the others do
  std::span<const uint8_t> mask = {};                        // width * height of the camera, 0 hides the place; empty: nothing does
};

// Frame of the place as of the pose, metres. A ball that reaches behind the camera's plane counts when the camera is nearer than four radii.
// Of a ball, the mask's pixel nearest to its middle decides. False for places that are not finite.
bool Shows(const Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x_in_enu, const SightRule& rule = {});

}  // namespace skyquilt::camera
