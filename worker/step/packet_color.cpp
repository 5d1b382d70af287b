#include "worker/step/packet_color.h"

#include <algorithm>
#include <numeric>

namespace skyquilt::worker {
namespace {

constexpr float kLeastColorSlope = 0.02F;

}  // namespace

void PacketColor::Forward(PacketSamples& s) const {
  float* sh = s.a.color_in + static_cast<size_t>(field::kGeometryRows) * s.a.stride;
  for (size_t k = 0; k < s.views.size(); ++k) {
    const Eigen::Vector3f direction = s.Ray(k).ray.direction_enu.cast<float>();
    shared_.field.EncodeDirection(direction.data(), s.views[k].count, sh + s.views[k].begin, s.a.stride);
    if (s.step->codes == nullptr) continue;
    shared_.field.EncodeAppearance(s.step->codes->Of(s.Ray(k).ray.photo), s.views[k].count, sh + s.views[k].begin, s.a.stride);
  }
  s.ZeroPadding(sh, shared_.field.ColorInputRows() - field::kGeometryRows, s.a.stride);
  shared_.field.Color(s.step->weights, s.a.color_in, s.a.stride, s.Padded(), s.a.color_hidden, s.a.stride, s.a.color_raw, s.a.stride);
  const auto range = static_cast<float>(shared_.target.config.color_range);
  for (size_t c = 0; c < 3; ++c) kernel::Sigmoid(s.a.color_raw + c * s.a.stride, s.Padded(), range, s.rgb.data() + c * s.a.stride);
}

// d rgb / d raw = rgb (1 - rgb / range). In a dark or bright survey colours that reach the end of their range in the first steps would get no
// gradient and stay there, so a step towards the middle of the range has at least kLeastColorSlope. A step outwards has not: black pixels, glare
// and sky ask for it in every step, and the networks' weights would grow without end.
int64_t PacketColor::FinishGradient(PacketSamples& s) const {
  const auto range = static_cast<float>(shared_.target.config.color_range);
  int64_t saturated = 0;
  for (size_t c = 0; c < 3; ++c) {
    float* gradient = s.a.color_gradient + c * s.a.stride;
    const float* color = s.rgb.data() + c * s.a.stride;
    for (size_t i = 0; i < static_cast<size_t>(s.live); ++i) {
      const float slope = color[i] * (1.0F - color[i] / range);
      const bool inwards = (gradient[i] > 0.0F) == (color[i] > 0.5F * range);
      gradient[i] *= inwards ? std::max(slope, kLeastColorSlope) : slope;
      if (slope < kLeastColorSlope) ++saturated;
    }
  }
  s.ZeroPadding(s.a.color_gradient, field::kColorRows, s.a.stride);
  return saturated;
}

void PacketColor::SumCodeGradients(const PacketSamples& s) const {
  if (s.step->code_gradients == nullptr) return;
  const size_t numbers = s.step->codes->numbers();
  for (size_t k = 0; k < s.views.size(); ++k) {
    float* of_ray = s.step->code_gradients + (static_cast<size_t>(s.packet->first_ray) + k) * numbers;
    for (size_t number = 0; number < numbers; ++number) {
      const float* row = s.a.appearance_gradient + number * s.a.stride + s.views[k].begin;
      of_ray[number] = std::accumulate(row, row + s.views[k].count, 0.0F);
    }
  }
}

}  // namespace skyquilt::worker
