#include "worker/field_step.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/render/march.h"
#include "worker/field_step_worker.h"

namespace skyquilt::worker {
namespace {

constexpr int64_t kEncodePackets = 16;  // one task: enough work, and a part's table stays in cache meanwhile
// Where less light than this arrives, a sample gets neither colour nor gradient.
const float kHiddenDepth = -std::log(1e-3F);
// Behind this optical depth the context is not looked at: it would show through at less than 2 %.
constexpr float kOpaqueDepth = 4.0F;
constexpr double kMeansFollow = 0.1;  // share of a new batch in the running means

// Reads a part's table once in order. Corners read it at random, and memory is several times slower at that than at one pass in front of it.
// The sum only keeps the compiler from leaving it out.
float ReadAhead(const float* table, int64_t floats) {
  float sum = 0.0F;
  for (int64_t i = 0; i < floats; i += kernel::kLineFloats) sum += table[i];
  return sum;
}

}  // namespace

FieldStep::FieldStep(const render::TrainedField& target, const field::HashField& field, const render::TrainedField* context,
                     const LuminancePlan& luminance, base::ThreadPool& threads, StageTimes& times)
    : target_(target),
      field_(field),
      context_(context),
      luminance_(luminance.luminance),
      state_(luminance.start),
      controls_mean_(luminance.controls_mean),
      threads_(threads),
      times_(times),
      optimizer_(field, threads) {
  for (int i = 0; i < threads.size(); ++i) {
    workers_.push_back(std::make_unique<Worker>());
    if (context == nullptr) continue;
    render::FieldSet set;
    set.context = context;
    workers_.back()->context = std::make_unique<render::RayRenderer>(set, render::EngineOptions::For(luminance_));
  }
}

FieldStep::~FieldStep() = default;

void FieldStep::Encode(const RayBatch& batch, std::span<const float> grid) {
  if (batch.packets.empty()) return;
  const Packet& last = batch.packets.back();
  Grow(features_, last.features + last.stride * static_cast<size_t>(field_.FeatureRows()));
  const auto packets = static_cast<int64_t>(batch.packets.size());
  const int64_t stretches = (packets + kEncodePackets - 1) / kEncodePackets;
  const encoding::Encoding& encoding = field_.encoding();
  threads_.ParallelFor(stretches * encoding.parts(), [&](int64_t task, int thread) {
    const auto start = StageTimes::Clock::now();
    const int part = static_cast<int>(task / stretches);
    const float* table = grid.data() + encoding.Offset(part);
    const int64_t stretch = task % stretches;
    const int64_t floats = encoding.Offset(part + 1) - encoding.Offset(part);
    const int64_t readers = std::min<int64_t>(threads_.size(), stretches);
    // Worth it when the samples will want most of the table.
    if (stretch < readers && 4 * batch.n_samples > floats / kernel::kLineFloats) {
      const int64_t length = floats / readers / kernel::kLineFloats * kernel::kLineFloats;
      workers_[static_cast<size_t>(thread)]->read_ahead = ReadAhead(table + stretch * length, length);
    }
    const auto first = static_cast<size_t>(stretch * kEncodePackets);
    const auto end = std::min(first + static_cast<size_t>(kEncodePackets), batch.packets.size());
    for (size_t k = first; k < end; ++k) {
      const Packet& p = batch.packets[k];
      encoding.Forward(part, table, batch.x.data() + p.begin, batch.y.data() + p.begin, batch.z.data() + p.begin, p.count,
                       features_.data() + p.features + static_cast<size_t>(encoding.FirstRow(part)) * p.stride, p.stride);
    }
    times_.Add(thread, Stage::kEncode, start);
  });
}

void FieldStep::Density(const Packet& packet, Worker& w) {
  const int64_t padded = kernel::Padded(packet.count);
  w.Reserve(field_, padded);
  float* features = features_.data() + packet.features;
  const auto rows = static_cast<size_t>(field_.FeatureRows());
  for (size_t row = 0; row < rows; ++row) std::fill(features + row * packet.stride + packet.count, features + row * packet.stride + padded, 0.0F);
  field_.Density(weights_, features, packet.stride, padded, w.a.density_hidden, w.a.stride, w.a.geometry(), w.a.stride);
  kernel::ExpShifted(w.a.geometry(), padded, static_cast<float>(target_.config.density_bias), kMaxLogDepth, w.depth.data());
}

// Keeps the samples that light still reaches; what lies behind an opaque surface gets neither colour nor gradient.
int64_t FieldStep::DropHidden(RayBatch& batch, const Packet& packet, Worker& w) {
  const int64_t padded = kernel::Padded(packet.count);
  w.views.assign(static_cast<size_t>(packet.n_rays), {});
  int64_t live = 0;
  for (int64_t k = 0; k < packet.n_rays; ++k) {
    const BatchRay& r = batch.rays[static_cast<size_t>(packet.first_ray + k)];
    RayView& view = w.views[static_cast<size_t>(k)];
    view.begin = live;
    float passed = 0.0F;
    int64_t i = 0;
    for (; i < r.count && passed < kHiddenDepth; ++i) {
      const auto s = static_cast<size_t>(r.begin + i);
      const auto local = static_cast<size_t>(r.begin + i - packet.begin);
      const float tau = w.depth[local] * batch.unit_length[s];
      passed += tau;
      w.keep[local] = 1.0F;
      w.tau[static_cast<size_t>(live++)] = tau;
      observed_[s] = w.depth[local];
    }
    view.count = i;
    for (; i < r.count; ++i) {
      w.keep[static_cast<size_t>(r.begin + i - packet.begin)] = 0.0F;
      observed_[static_cast<size_t>(r.begin + i)] = 0.0F;
    }
  }
  if (live == packet.count) return live;
  std::fill(w.keep.begin() + packet.count, w.keep.begin() + padded, 0.0F);
  float* features = features_.data() + packet.features;
  kernel::Compact(w.keep.data(), padded, field_.FeatureRows(), features, packet.stride, features, packet.stride);
  kernel::Compact(w.keep.data(), padded, w.a.kept_rows, w.a.density_hidden, w.a.stride, w.a.density_hidden, w.a.stride);
  for (auto* v : {&batch.x, &batch.y, &batch.z, &batch.t}) {
    kernel::Compact(w.keep.data(), padded, 1, v->data() + packet.begin, 0, v->data() + packet.begin, 0);
  }
  // Padding takes part in the networks' sums: it must be finite.
  const int64_t end = kernel::Padded(live);
  for (int row = 0; row < field_.FeatureRows(); ++row) {
    float* values = features + static_cast<size_t>(row) * packet.stride;
    std::fill(values + live, values + end, 0.0F);
  }
  for (int row = 0; row < w.a.kept_rows; ++row) {
    float* values = w.a.density_hidden + static_cast<size_t>(row) * w.a.stride;
    std::fill(values + live, values + end, 0.0F);
  }
  return live;
}

void FieldStep::Color(const RayBatch& batch, const Packet& packet, int64_t n, Worker& w) const {
  const int64_t padded = kernel::Padded(n);
  float* sh = w.a.color_in + static_cast<size_t>(field::kGeometryRows) * w.a.stride;
  for (int64_t k = 0; k < packet.n_rays; ++k) {
    const RayView& view = w.views[static_cast<size_t>(k)];
    const Eigen::Vector3f direction = batch.rays[static_cast<size_t>(packet.first_ray + k)].ray.direction_enu.cast<float>();
    field_.FillDirection(direction.data(), view.count, sh + view.begin, w.a.stride);
  }
  for (int row = 0; row < field_.ColorInputRows() - field::kGeometryRows; ++row) {
    float* values = sh + static_cast<size_t>(row) * w.a.stride;
    std::fill(values + n, values + padded, 0.0F);
  }
  field_.Color(weights_, w.a.color_in, w.a.stride, padded, w.a.color_hidden, w.a.stride, w.a.color_raw, w.a.stride);
  for (size_t c = 0; c < 3; ++c) {
    kernel::Sigmoid(w.a.color_raw + c * w.a.stride, padded, static_cast<float>(target_.config.color_range), w.rgb.data() + c * w.a.stride);
  }
}

// What the frozen context shows in front of the box's ground plan and, where light passes through, behind it.
void FieldStep::LookThroughContext(const RayBatch& batch, const Packet& packet, Worker& w) const {
  if (context_ == nullptr) return;
  w.pieces.clear();
  w.owner.clear();
  for (size_t k = 0; k < w.views.size(); ++k) {
    const BatchRay& r = batch.rays[static_cast<size_t>(packet.first_ray) + k];
    if (r.ray.empty) continue;
    const render::Stretch all = render::FieldStretch(context_->map, r.ray.origin_enu, r.ray.direction_enu);
    if (all.Empty()) continue;
    const render::Stretch plan = render::PlanStretch(target_.map, r.ray.origin_enu, r.ray.direction_enu);
    if (plan.t_near > all.t_near + context_->step_m) {
      w.pieces.push_back({r.ray.origin_enu, r.ray.direction_enu, all.t_near, plan.t_near, 0.0F});
      w.owner.emplace_back(k, false);
    }
    const RayView& view = w.views[k];
    float depth = 0.0F;
    for (int64_t i = 0; i < view.count; ++i) depth += w.tau[static_cast<size_t>(view.begin + i)];
    if (depth < kOpaqueDepth && all.t_far > plan.t_far) {
      w.pieces.push_back({r.ray.origin_enu, r.ray.direction_enu, plan.t_far, all.t_far, 0.0F});
      w.owner.emplace_back(k, true);
    }
  }
  w.colors.resize(w.pieces.size());
  w.context->Render(w.pieces, w.colors);
  for (size_t i = 0; i < w.pieces.size(); ++i) {
    RayView& view = w.views[w.owner[i].first];
    const bool behind = w.owner[i].second;
    for (size_t c = 0; c < 3; ++c) {
      (behind ? view.behind_rgb : view.front_rgb)[c] = w.colors[i].rgb_srgb[c];
      (behind ? view.behind_light : view.front_light)[c] = w.colors[i].concealed_light[c];
    }
    // Whatever the context leaves open behind shows the random background.
    (behind ? view.background_share : view.front_transmittance) = 1.0F - w.colors[i].opacity;
  }
}

FieldStep::PacketResult FieldStep::TrainPacket(RayBatch& batch, const Packet& packet, float ray_share, double distortion, float* network_gradient,
                                               Worker& w, int thread) {
  auto at = StageTimes::Clock::now();
  Density(packet, w);
  const int64_t n = DropHidden(batch, packet, w);
  at = times_.Add(thread, Stage::kDensity, at);
  Color(batch, packet, n, w);
  at = times_.Add(thread, Stage::kColor, at);
  LookThroughContext(batch, packet, w);
  at = times_.Add(thread, Stage::kContext, at);
  PacketResult result = luminance_.On() ? ConcealAndLoss(batch, packet, n, ray_share, distortion, network_gradient, w)
                                        : ComposeAndLoss(batch, packet, n, ray_share, distortion, w);
  at = times_.Add(thread, Stage::kCompose, at);
  result.live = n;
  if (n > 0) {
    const int64_t padded = kernel::Padded(n);
    float* features = features_.data() + packet.features;
    field_.Backward(weights_, w.a, features, packet.stride, padded, network_gradient);
    for (int row = 0; row < field_.FeatureRows(); ++row) {
      result.finite = result.finite && kernel::AllFinite(features + static_cast<size_t>(row) * packet.stride, n);
    }
  }
  times_.Add(thread, Stage::kBackward, at);
  return result;
}

StepResult FieldStep::Train(RayBatch& batch, const StepOptions& options, field::Parameters& parameters, field::TrainableState& state,
                            brightness::ResponseLearner* learner) {
  StepResult result;
  result.n_rays = static_cast<int>(batch.rays.size());
  result.n_samples = batch.n_samples;
  weights_ = field_.Prepare(parameters.networks);
  Encode(batch, parameters.grid);
  Grow(observed_, static_cast<size_t>(batch.Size()));
  const size_t n_packets = batch.packets.size();
  results_.assign(n_packets, {});
  const auto network_size = static_cast<size_t>(field_.NetworkParameters());
  slot_gradients_.assign(network_size * kGradientSlots, 0.0F);
  gain_gradients_.assign(learner != nullptr ? batch.rays.size() : 0, {0.0F, 0.0F, 0.0F});
  const float ray_share = 1.0F / static_cast<float>(std::max(1, result.n_rays));
  threads_.ParallelFor(kGradientSlots, [&](int64_t slot, int thread) {
    for (size_t k = static_cast<size_t>(slot); k < n_packets; k += kGradientSlots) {
      results_[k] = TrainPacket(batch, batch.packets[k], ray_share, options.distortion,
                                slot_gradients_.data() + static_cast<size_t>(slot) * network_size, *workers_[static_cast<size_t>(thread)], thread);
    }
  });
  auto at = StageTimes::Clock::now();
  LossSums sums;
  stretches_.clear();
  for (size_t k = 0; k < n_packets; ++k) {
    const PacketResult& p = results_[k];
    result.loss += p.sums.loss;
    result.squared_error += p.sums.squared_error;
    result.n_live += p.live;
    result.finite = result.finite && p.finite;
    sums.color_rays += p.sums.color_rays;
    sums.solid_rays += p.sums.solid_rays;
    sums.shown += p.sums.shown;
    sums.log_share += p.sums.log_share;
    const Packet& packet = batch.packets[k];
    stretches_.push_back({packet.begin, p.live, features_.data() + packet.features, packet.stride});
  }
  result.loss *= static_cast<double>(ray_share);
  result.squared_error /= 3.0 * static_cast<double>(std::max<int64_t>(1, sums.color_rays));
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    for (size_t i = 0; i < network_size; ++i) state.network_gradient[i] += slot_gradients_[slot * network_size + i];
  }
  result.finite = result.finite && std::isfinite(result.loss) && kernel::AllFinite(state.network_gradient.data(), static_cast<int64_t>(network_size));
  if (!result.finite) {
    std::fill(state.network_gradient.begin(), state.network_gradient.end(), 0.0F);
    ++state.step;  // the same rays would fail the same way
    return result;
  }
  FollowMeans(sums);
  for (size_t k = 0; k < gain_gradients_.size(); ++k) {
    const PixelRay& ray = batch.rays[k].ray;
    if (!ray.empty) learner->Add(static_cast<size_t>(ray.photo), gain_gradients_[k].data(), ray_share);
  }
  times_.Add(0, Stage::kBackward, at);
  optimizer_.Update(
      batch.x.data(), batch.y.data(), batch.z.data(), stretches_, options.learning_rate, options.network_l2, parameters, state,
      [&](int thread, StageTimes::Clock::time_point began) { times_.Add(thread, Stage::kScatter, began); },
      [&](int thread, StageTimes::Clock::time_point began) { times_.Add(thread, Stage::kOptimise, began); });
  return result;
}

void FieldStep::FollowMeans(const LossSums& sums) {
  if (!luminance_.On() || !controls_mean_) return;
  if (sums.color_rays > 0) {
    const double shown = sums.shown / (3.0 * static_cast<double>(sums.color_rays));
    state_.mean_shown += kMeansFollow * (shown - state_.mean_shown);
  }
  if (sums.solid_rays > 0) state_.mean_log_gain += kMeansFollow * (sums.log_share / static_cast<double>(sums.solid_rays) - state_.mean_log_gain);
}

void FieldStep::Infer(RayBatch& batch, const field::Parameters& parameters) {
  weights_ = field_.Prepare(parameters.networks);
  Encode(batch, parameters.grid);
  threads_.ParallelFor(static_cast<int64_t>(batch.packets.size()), [&](int64_t k, int thread) {
    const Packet& packet = batch.packets[static_cast<size_t>(k)];
    Worker& w = *workers_[static_cast<size_t>(thread)];
    auto at = StageTimes::Clock::now();
    Density(packet, w);
    w.views.assign(static_cast<size_t>(packet.n_rays), {});
    for (size_t i = 0; i < w.views.size(); ++i) {
      const BatchRay& r = batch.rays[static_cast<size_t>(packet.first_ray) + i];
      w.views[i].begin = r.begin - packet.begin;
      w.views[i].count = r.count;
    }
    at = times_.Add(thread, Stage::kDensity, at);
    Color(batch, packet, packet.count, w);
    times_.Add(thread, Stage::kColor, at);
  });
}

}  // namespace skyquilt::worker
