#include "worker/step/packet_trainer.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

// tau in front of a sample beyond which it gets neither colour nor gradient: less than 0.1 % of the light arrives.
const float kHiddenTau = -std::log(1e-3F);

}  // namespace

PacketTrainer::PacketTrainer(const PacketShared& shared, PhaseTimes& times, int thread) : shared_(shared), times_(times), thread_(thread) {
  if (shared.context == nullptr) return;
  render::FieldSet set;
  set.context = shared.context;
  context_ = std::make_unique<render::RayRenderer>(set, render::EngineOptions::For(shared.luminance));
}

PacketResult PacketTrainer::Train(const PacketStep& step, const Packet& packet, float* network_gradient) {
  auto at = PhaseTimes::Clock::now();
  Begin(step, packet);
  Density();
  DropHidden();
  at = times_.Add(thread_, Phase::kDensity, at);
  Color();
  at = times_.Add(thread_, Phase::kColor, at);
  RenderContext();
  at = times_.Add(thread_, Phase::kContext, at);
  PacketResult result;
  result.live = live_;
  if (shared_.luminance.On()) {
    ConcealAndLoss(network_gradient, result.sums);
  } else {
    ComposeAndLoss(result.sums);
  }
  const float* more_geometry_gradient = nullptr;
  if (step.surface_points != nullptr) {
    SurfacePoints& points = step.surface_points[&packet - step.batch.packets.data()];
    if (AddNormalLosses(points, network_gradient, result.sums)) more_geometry_gradient = geometry_gradient_.data();
    result.finite = kernel::AllFinite(points.feature_gradient.data(), static_cast<int64_t>(points.feature_gradient.size())) &&
                    kernel::AllFinite(points.along.data(), static_cast<int64_t>(points.along.size()));
  }
  result.saturated = saturated_;
  at = times_.Add(thread_, Phase::kCompose, at);
  if (live_ > 0) result.finite = Backward(network_gradient, more_geometry_gradient) && result.finite;
  times_.Add(thread_, Phase::kBackward, at);
  return result;
}

void PacketTrainer::Infer(const PacketStep& step, const Packet& packet) {
  auto at = PhaseTimes::Clock::now();
  Begin(step, packet);
  Density();
  KeepAll();
  at = times_.Add(thread_, Phase::kDensity, at);
  Color();
  times_.Add(thread_, Phase::kColor, at);
}

void PacketTrainer::Begin(const PacketStep& step, const Packet& packet) {
  step_ = &step;
  packet_ = &packet;
  live_ = packet.count;
  saturated_ = {};
  a_.Reserve(shared_.field, kernel::Padded(packet.count));
  for (auto* v : {&depth_, &keep_, &tau_, &weight_}) Grow(*v, a_.stride);
  Grow(rgb_, 3 * a_.stride);
  views_.assign(static_cast<size_t>(packet.n_rays), {});
}

// The networks' sums include padding, so it must be finite.
void PacketTrainer::ZeroPadding(float* rows, int n_rows, size_t stride) const {
  const int64_t end = kernel::Padded(live_);
  for (int row = 0; row < n_rows; ++row) {
    float* values = rows + static_cast<size_t>(row) * stride;
    std::fill(values + live_, values + end, 0.0F);
  }
}

void PacketTrainer::Density() {
  const int64_t padded = kernel::Padded(packet_->count);
  float* features = Features();
  ZeroPadding(features, shared_.field.FeatureRows(), packet_->stride);
  shared_.field.Density(shared_.weights, features, packet_->stride, padded, a_.density_hidden, a_.stride, a_.geometry(), a_.stride);
  kernel::ExpShifted(a_.geometry(), padded, static_cast<float>(shared_.target.config.density_bias), kMaxLogTau, depth_.data());
}

void PacketTrainer::KeepAll() {
  for (size_t k = 0; k < views_.size(); ++k) {
    views_[k].begin = Ray(k).begin - packet_->begin;
    views_[k].count = Ray(k).count;
  }
}

// Keeps only the samples that light reaches: samples behind an opaque surface get neither colour nor gradient.
void PacketTrainer::DropHidden() {
  int64_t live = 0;
  for (size_t k = 0; k < views_.size(); ++k) live += LiveSamples(k, live);
  live_ = live;
  if (live == packet_->count) return;
  const int64_t padded = kernel::Padded(packet_->count);
  std::fill(keep_.begin() + packet_->count, keep_.begin() + padded, 0.0F);
  float* features = Features();
  kernel::Compact(keep_.data(), padded, shared_.field.FeatureRows(), features, packet_->stride, features, packet_->stride);
  kernel::Compact(keep_.data(), padded, a_.kept_rows, a_.density_hidden, a_.stride, a_.density_hidden, a_.stride);
  RayBatch& batch = step_->batch;
  for (auto* v : {&batch.x, &batch.y, &batch.z}) {
    kernel::Compact(keep_.data(), padded, batch.points, v->data() + packet_->begin, batch.plane, v->data() + packet_->begin, batch.plane);
  }
  for (auto* v : {&batch.sharpness, &batch.t}) {
    kernel::Compact(keep_.data(), padded, 1, v->data() + packet_->begin, 0, v->data() + packet_->begin, 0);
  }
  ZeroPadding(features, shared_.field.FeatureRows(), packet_->stride);
  ZeroPadding(a_.density_hidden, a_.kept_rows, a_.stride);
}

// Finds the samples of a ray that light reaches and writes their optical depths to tau_ from first_live. Returns their number.
int64_t PacketTrainer::LiveSamples(size_t view, int64_t first_live) {
  const BatchRay& r = Ray(view);
  const float* unit_length = step_->batch.unit_length.data();
  int64_t live = first_live;
  float passed = 0.0F;
  int64_t i = 0;
  for (; i < r.count && passed < kHiddenTau; ++i) {
    const auto s = static_cast<size_t>(r.begin + i);
    const auto local = static_cast<size_t>(r.begin + i - packet_->begin);
    const float tau = depth_[local] * unit_length[s];
    passed += tau;
    keep_[local] = 1.0F;
    tau_[static_cast<size_t>(live++)] = tau;
    step_->observed[s] = depth_[local];
  }
  views_[view].begin = first_live;
  views_[view].count = i;
  for (; i < r.count; ++i) {
    keep_[static_cast<size_t>(r.begin + i - packet_->begin)] = 0.0F;
    step_->observed[static_cast<size_t>(r.begin + i)] = 0.0F;
  }
  return live - first_live;
}

void PacketTrainer::Color() {
  const int64_t padded = kernel::Padded(live_);
  float* sh = a_.color_in + static_cast<size_t>(field::kGeometryRows) * a_.stride;
  for (size_t k = 0; k < views_.size(); ++k) {
    const Eigen::Vector3f direction = Ray(k).ray.direction_enu.cast<float>();
    shared_.field.EncodeDirection(direction.data(), views_[k].count, sh + views_[k].begin, a_.stride);
  }
  ZeroPadding(sh, shared_.field.ColorInputRows() - field::kGeometryRows, a_.stride);
  shared_.field.Color(shared_.weights, a_.color_in, a_.stride, padded, a_.color_hidden, a_.stride, a_.color_raw, a_.stride);
  for (size_t c = 0; c < 3; ++c) {
    kernel::Sigmoid(a_.color_raw + c * a_.stride, padded, static_cast<float>(shared_.target.config.color_range), rgb_.data() + c * a_.stride);
  }
}

// Replaces the features by their gradient; false when it is not finite.
bool PacketTrainer::Backward(float* network_gradient, const float* more_geometry_gradient) {
  float* features = Features();
  shared_.field.Backward(shared_.weights, a_, features, packet_->stride, kernel::Padded(live_), network_gradient, more_geometry_gradient);
  bool finite = true;
  for (int row = 0; row < shared_.field.encoding().OutputRows(); ++row) {
    finite = finite && kernel::AllFinite(features + static_cast<size_t>(row) * packet_->stride, live_);
  }
  return finite;
}

}  // namespace skyquilt::worker
