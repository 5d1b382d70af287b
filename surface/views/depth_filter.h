// Which rendered depths are good enough for a surface.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/render/ray.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct DepthLimits {
  double min_opacity = 0.5;
  double max_free_opacity = -1.0;    // of rays that meet nothing; negative: no ray is known to
  double max_spread_m = 0.0;         // between front and back of the surface along the ray
  bool spread_across = false;        // or at right angles to the surface: at a flat angle even a thin blur is long
  double max_step_m = 0.0;           // to the neighbouring pixels on both sides
  double max_angle_deg = 80.0;       // between ray and surface normal
  Eigen::Vector3d min_enu, max_enu;  // box outside which depths are dropped
};

// A rendered picture in memory. See DepthView.
struct RenderedView {
  ViewPose pose;
  std::vector<float> depth_m;
  std::vector<uint8_t> cosine;
  std::vector<uint8_t> weight;
  std::vector<float> spread_m;  // between front and back of the surface along the ray; empty but between rendering and FilterDepths
  DepthView Get() const { return {pose, depth_m, cosine, weight}; }
};

// The median depth of a rendered ray; NaN when it is transparent, blurred, unknown or outside the box. With spread_across only what is blurred too
// much at any allowed angle counts as blurred.
float TrustedDepth(const render::Ray& ray, const render::RayColor& color, const DepthLimits& limits);

// Drops depths that stick out from both neighbours of a row or of a column, which come from pixels that mix two surfaces, and those seen at too large
// an angle, or, with spread_across, blurred; then fills the cosines. Normals come from differences to the nearest neighbours; a pixel without
// neighbours counts as seen at right angles.
void FilterDepths(RenderedView& view, const DepthLimits& limits, base::ThreadPool& threads);

}  // namespace skyquilt::surface
