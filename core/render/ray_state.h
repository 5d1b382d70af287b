// What a ray has gathered on its way so far. It can be carried from field to field and from rank to rank: the exact composition
// C = sum_k (prod_{i<k} T_i) C_k, done front to back without ever splitting a ray's sums.
#pragma once

#include <limits>
#include <type_traits>

#include "core/geo/ray_box.h"
#include "core/render/ray.h"

namespace skyquilt::render {

struct RayState {
  double transmittance = 1.0;
  double depth_moment = 0.0;                                    // sum of weight times distance, metres
  float rgb_srgb[3] = {0, 0, 0};                                // sum of weight times colour, display values
  float concealed_light[3] = {0, 0, 0};                         // the same with held-back light, linear
  float light_passed = 1.0F;                                    // product of the samples' factors that hold light back
  float depth_front = std::numeric_limits<float>::quiet_NaN();  // as in RayColor
  float depth_median = std::numeric_limits<float>::quiet_NaN();
  float depth_back = std::numeric_limits<float>::quiet_NaN();
  bool ended = false;  // too little light is left to go on
};
static_assert(std::is_trivially_copyable_v<RayState>);

// An interval [from, to) of a ray, metres.
struct Window {
  double from = 0.0;
  double to = std::numeric_limits<double>::infinity();
  bool Meets(const geo::Interval& interval) const { return !interval.Empty() && interval.t_far > from && interval.t_near < to; }
};

// What a ray shows that goes no farther. What was gathered by one that ended early is taken for all.
RayColor Finished(const RayState& state);

}  // namespace skyquilt::render
