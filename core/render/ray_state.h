// The partial result of a ray that is rendered in several steps. It is passed from field to field and from rank to rank, and gives exactly the
// composition C = sum_k (prod_{i<k} T_i) C_k over the parts k of the ray, because each part adds to the sums of the previous ones.
#pragma once

#include <limits>
#include <type_traits>

#include "core/geo/ray_box.h"
#include "core/render/ray.h"

namespace skyquilt::render {

struct RayState {
  double transmittance = 1.0;
  double depth_moment = 0.0;                                    // sum of weight * t, metres
  float rgb_srgb[3] = {0, 0, 0};                                // sum of weight * colour, display values
  float concealed_light[3] = {0, 0, 0};                         // the same for the concealed rendering, linear light
  float light_passed = 1.0F;                                    // product of the samples' Omegas (core/render/concealed.h)
  float depth_front = std::numeric_limits<float>::quiet_NaN();  // as in RayColor
  float depth_median = std::numeric_limits<float>::quiet_NaN();
  float depth_back = std::numeric_limits<float>::quiet_NaN();
  float density_normal[3] = {0, 0, 0};    // sums of weight * normal, ENU
  float predicted_normal[3] = {0, 0, 0};  // of fields with a head
  bool ended = false;                     // transmittance is too small to continue
};
static_assert(std::is_trivially_copyable_v<RayState>);

// An interval [from, to) of a ray, metres.
struct Window {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  bool Overlaps(const geo::Interval& interval) const { return !interval.Empty() && interval.t_far > from && interval.t_near < to; }
};

// Final colour of a ray. A ray that ended early is scaled to opacity 1.
RayColor FinalColor(const RayState& state);

}  // namespace skyquilt::render
