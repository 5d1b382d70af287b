#include "worker/step/packet_density.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

// tau in front of a sample beyond which it gets neither colour nor gradient: less than 0.1 % of the light arrives.
const float kHiddenTau = -std::log(1e-3F);
// tau of a sample beyond which it gets no denser: less than 1 % of the light passes, so more density changes nothing but its own parameters.
constexpr float kNoDenserTau = 5.0F;
// A sample this dense has left the range that a scene can need.
constexpr float kSaturatedTau = 1e4F;

}  // namespace

void PacketDensity::Forward(PacketSamples& s) {
  Grow(depth_, s.a.stride);
  Grow(keep_, s.a.stride);
  if (Activation() != field::DensityActivation::kExp) Grow(slope_, s.a.stride);
  float* features = s.Features();
  s.ZeroPadding(features, shared_.field.FeatureRows(), s.packet->stride);
  shared_.field.Density(s.step->weights, features, s.packet->stride, s.Padded(), s.a.density_hidden, s.a.stride, s.a.geometry(), s.a.stride);
  shared_.field.StepTau(s.a.geometry(), s.Padded(), kMaxLogTau, depth_.data());
}

void PacketDensity::KeepAll(PacketSamples& s) {
  for (size_t k = 0; k < s.views.size(); ++k) {
    s.views[k].begin = s.Ray(k).begin - s.packet->begin;
    s.views[k].count = s.Ray(k).count;
  }
}

void PacketDensity::DropHidden(PacketSamples& s) {
  const int64_t padded = s.Padded(), begin = s.packet->begin;
  int64_t live = 0;
  for (size_t k = 0; k < s.views.size(); ++k) live += LiveSamples(s, k, live);
  s.live = live;
  if (live == s.packet->count) return;
  std::fill(keep_.begin() + s.packet->count, keep_.begin() + padded, 0.0F);
  float* features = s.Features();
  kernel::Compact(keep_.data(), padded, shared_.field.FeatureRows(), features, s.packet->stride, features, s.packet->stride);
  kernel::Compact(keep_.data(), padded, s.a.kept_rows, s.a.density_hidden, s.a.stride, s.a.density_hidden, s.a.stride);
  RayBatch& batch = s.step->batch;
  for (auto* v : {&batch.x, &batch.y, &batch.z}) {
    kernel::Compact(keep_.data(), padded, batch.points, v->data() + begin, batch.plane, v->data() + begin, batch.plane);
  }
  for (auto* v : {&batch.sharpness, &batch.t}) kernel::Compact(keep_.data(), padded, 1, v->data() + begin, 0, v->data() + begin, 0);
  s.ZeroPadding(features, shared_.field.FeatureRows(), s.packet->stride);
  s.ZeroPadding(s.a.density_hidden, s.a.kept_rows, s.a.stride);
}

int64_t PacketDensity::LiveSamples(PacketSamples& s, size_t view, int64_t first_live) {
  const BatchRay& r = s.Ray(view);
  const float* unit_length = s.step->batch.unit_length.data();
  const field::DensityActivation activation = Activation();
  const bool keeps_slope = activation != field::DensityActivation::kExp;
  int64_t live = first_live;
  float passed = 0.0F;
  int64_t i = 0;
  for (; i < r.count && passed < kHiddenTau; ++i) {
    const auto in_batch = static_cast<size_t>(r.begin + i);
    const auto local = static_cast<size_t>(r.begin + i - s.packet->begin);
    const float tau = depth_[local] * unit_length[in_batch];
    passed += tau;
    keep_[local] = 1.0F;
    if (keeps_slope) slope_[static_cast<size_t>(live)] = field::TauSlope(activation, depth_[local]) * unit_length[in_batch];
    s.tau[static_cast<size_t>(live++)] = tau;
    s.step->observed[in_batch] = depth_[local];
  }
  s.views[view].begin = first_live;
  s.views[view].count = i;
  for (; i < r.count; ++i) {
    keep_[static_cast<size_t>(r.begin + i - s.packet->begin)] = 0.0F;
    s.step->observed[static_cast<size_t>(r.begin + i)] = 0.0F;
  }
  return live - first_live;
}

int64_t PacketDensity::FinishGradient(PacketSamples& s) const {
  int64_t saturated = 0;
  // d tau / d log density, which is tau with exp; but 0 where a step would make an opaque sample denser.
  const float* const slope = Activation() == field::DensityActivation::kExp ? s.tau.data() : slope_.data();
  for (size_t i = 0; i < static_cast<size_t>(s.live); ++i) {
    float& gradient = s.a.log_density_gradient[i];
    gradient = s.tau[i] > kNoDenserTau && gradient < 0.0F ? 0.0F : gradient * slope[i];
    if (s.tau[i] > kSaturatedTau) ++saturated;
  }
  s.ZeroPadding(s.a.log_density_gradient, 1, s.a.stride);
  return saturated;
}

}  // namespace skyquilt::worker
