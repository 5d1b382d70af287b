#include "core/render/ray_state.h"

#include <algorithm>

namespace skyquilt::render {
namespace {

void Normalise(const float (&sum)[3], float (&normal)[3]) {
  const Eigen::Vector3f direction = Eigen::Vector3f(sum[0], sum[1], sum[2]).stableNormalized();
  if (direction.allFinite()) std::copy_n(direction.data(), 3, normal);
}

}  // namespace

RayColor FinalColor(const RayState& state) {
  RayColor color;
  const double opacity = state.ended ? 1.0 : 1.0 - state.transmittance;
  const auto gain = static_cast<float>(state.ended ? 1.0 / (1.0 - state.transmittance) : 1.0);
  for (size_t c = 0; c < 3; ++c) {
    color.rgb_srgb[c] = gain * state.rgb_srgb[c];
    color.concealed_light[c] = gain * state.concealed_light[c];
  }
  color.opacity = static_cast<float>(opacity);
  color.depth =
      color.opacity > 1e-6F ? static_cast<float>(state.depth_moment / (1.0 - state.transmittance)) : std::numeric_limits<float>::quiet_NaN();
  color.depth_front = state.depth_front;
  color.depth_median = state.depth_median;
  color.depth_back = state.depth_back;
  Normalise(state.density_normal, color.density_normal);
  Normalise(state.predicted_normal, color.predicted_normal);
  return color;
}

}  // namespace skyquilt::render
