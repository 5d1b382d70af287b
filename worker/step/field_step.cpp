#include "worker/step/field_step.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::worker {
namespace {

constexpr int64_t kEncodePackets = 16;  // packets per task: enough work, and the table stays in cache
constexpr double kMeansFollow = 0.1;    // weight of a new batch in the running means
// A batch with rare pixels must not turn the networks around: their gradient is clipped at this multiple of its running norm (Pascanu et al. 2013).
constexpr double kMostOfRunningNorm = 2.0;
constexpr double kNormFollows = 0.01;

// Loads the table of a part into the cache by reading it once in order, which is several times faster than the random reads of the encoding. The sum
// keeps the compiler from removing the loop.
float ReadAhead(const float* table, int64_t floats) {
  float sum = 0.0F;
  for (int64_t i = 0; i < floats; i += kernel::kLineFloats) sum += table[i];
  return sum;
}

}  // namespace

FieldStep::FieldStep(const render::TrainedField& target, const field::HashField& field, const render::TrainedField* context,
                     const LuminancePlan& luminance, base::ThreadPool& threads, PhaseTimes& times)
    : field_(field),
      luminance_(luminance.luminance),
      state_(luminance.start),
      threads_(threads),
      times_(times),
      optimizer_(field, threads),
      shared_{target, field, context, luminance_, state_, luminance.controls_mean},
      read_ahead_(static_cast<size_t>(threads.size())) {
  for (int i = 0; i < threads.size(); ++i) trainers_.push_back(std::make_unique<PacketTrainer>(shared_, times, i));
}

void FieldStep::Encode(const RayBatch& batch, std::span<const float> grid) {
  if (batch.packets.empty()) return;
  const Packet& last = batch.packets.back();
  Grow(features_, last.features + last.stride * static_cast<size_t>(field_.FeatureRows()));
  const auto packets = static_cast<int64_t>(batch.packets.size());
  const int64_t runs = (packets + kEncodePackets - 1) / kEncodePackets;
  const encoding::Encoding& encoding = field_.encoding();
  const kernel::Positions at = batch.Positions(field_.config());
  threads_.ParallelFor(runs * encoding.parts(), [&](int64_t task, int thread) {
    const auto start = PhaseTimes::Clock::now();
    const int part = static_cast<int>(task / runs);
    const float* table = grid.data() + encoding.Offset(part);
    const int64_t run = task % runs;
    const int64_t floats = encoding.Offset(part + 1) - encoding.Offset(part);
    const int64_t readers = std::min<int64_t>(threads_.size(), runs);
    // Only when the samples will read most of the table.
    if (run < readers && 4 * batch.n_samples > floats / kernel::kLineFloats) {
      const int64_t length = floats / readers / kernel::kLineFloats * kernel::kLineFloats;
      read_ahead_[static_cast<size_t>(thread)] = ReadAhead(table + run * length, length);
    }
    const auto first = static_cast<size_t>(run * kEncodePackets);
    const auto end = std::min(first + static_cast<size_t>(kEncodePackets), batch.packets.size());
    for (size_t k = first; k < end; ++k) {
      const Packet& p = batch.packets[k];
      encoding.Forward(part, table, at.From(p.begin), p.count,
                       features_.data() + p.features + static_cast<size_t>(encoding.FirstRow(part)) * p.stride, p.stride);
    }
    times_.Add(thread, Phase::kEncode, start);
  });
  if (field_.ScaleRows() == 0) return;
  threads_.ParallelFor(packets, [&](int64_t k, int thread) {
    const auto start = PhaseTimes::Clock::now();
    const Packet& p = batch.packets[static_cast<size_t>(k)];
    field_.EncodeScales(at.From(p.begin), p.count, features_.data() + p.features + static_cast<size_t>(encoding.OutputRows()) * p.stride, p.stride);
    times_.Add(thread, Phase::kEncode, start);
  });
}

StepResult FieldStep::Train(RayBatch& batch, const StepOptions& options, field::Parameters& parameters, field::OptimizerState& state,
                            brightness::ResponseLearner* learner, AppearanceCodes* codes, RayGradients* rays) {
  StepResult result;
  result.n_rays = static_cast<int>(batch.rays.size());
  result.n_samples = batch.n_samples;
  Encode(batch, parameters.grid);
  Grow(observed_, static_cast<size_t>(batch.Size()));
  const size_t n_packets = batch.packets.size();
  results_.assign(n_packets, {});
  // Later, packets have other points than in the step before, but the buffers stay.
  surface_points_.resize(options.priors.Normals() ? n_packets : 0);
  const auto network_size = static_cast<size_t>(field_.NetworkParameters());
  slot_gradients_.assign(network_size * kGradientSlots, 0.0F);
  gain_gradients_.assign(learner != nullptr ? batch.rays.size() : 0, {0.0F, 0.0F, 0.0F});
  if (codes != nullptr && !codes->On()) codes = nullptr;
  code_gradients_.assign(codes != nullptr ? batch.rays.size() * codes->numbers() : 0, 0.0F);
  if (rays != nullptr) rays->rays.assign(batch.rays.size(), {});
  const float ray_share = 1.0F / static_cast<float>(std::max(1, result.n_rays));
  const PacketStep step{.batch = batch,
                        .weights = field_.Prepare(parameters.networks),
                        .grid = parameters.grid,
                        .features = features_.data(),
                        .observed = observed_.data(),
                        .ray_share = ray_share,
                        .distortion = options.distortion,
                        .priors = options.priors,
                        .gain_gradients = gain_gradients_.empty() ? nullptr : gain_gradients_.data(),
                        .codes = codes,
                        .code_gradients = codes != nullptr ? code_gradients_.data() : nullptr,
                        .ray_gradients = rays,
                        .surface_points = options.priors.Normals() ? surface_points_.data() : nullptr};
  threads_.ParallelFor(kGradientSlots, [&](int64_t slot, int thread) {
    PacketTrainer& trainer = *trainers_[static_cast<size_t>(thread)];
    float* network_gradient = slot_gradients_.data() + static_cast<size_t>(slot) * network_size;
    for (size_t k = static_cast<size_t>(slot); k < n_packets; k += kGradientSlots) {
      results_[k] = trainer.Train(step, batch.packets[k], network_gradient);
    }
  });
  auto at = PhaseTimes::Clock::now();
  const LossSums sums = SumResults(ray_share, &result);
  result.finite = SumNetworkGradients(state) && result.finite && std::isfinite(result.loss);
  if (!result.finite) {
    std::fill(state.network_gradient.begin(), state.network_gradient.end(), 0.0F);
    ++state.step;  // the same rays would fail the same way
    return result;
  }
  ClipNetworkGradient(state, result);
  UpdateRunningMeans(sums);
  const bool shades = learner != nullptr && learner->shading().Learns();
  for (size_t k = 0; k < gain_gradients_.size(); ++k) {
    const PixelRay& ray = batch.rays[k].ray;
    if (ray.empty) continue;
    const std::array<float, 3>& gradient = gain_gradients_[k];
    learner->Add(static_cast<size_t>(ray.photo), gradient.data(), ray_share);
    if (shades) learner->shading().Add(static_cast<size_t>(ray.photo), ray.place, gradient[0] + gradient[1] + gradient[2], ray_share);
  }
  if (codes != nullptr) TrainCodes(batch, options.learning_rate, *codes);
  times_.Add(0, Phase::kBackward, at);
  optimizer_.Update(
      batch.Positions(field_.config()), gradient_segments_, options.learning_rate, options.network_l2, parameters, state,
      [&](int thread, PhaseTimes::Clock::time_point began) { times_.Add(thread, Phase::kScatter, began); },
      [&](int thread, PhaseTimes::Clock::time_point began) { times_.Add(thread, Phase::kOptimise, began); });
  return result;
}

LossSums FieldStep::SumResults(float ray_share, StepResult* result) {
  LossSums sums;
  gradient_segments_.clear();
  for (const PacketResult& p : results_) {
    result->n_live += p.gradient.count;
    result->finite = result->finite && p.finite;
    result->saturated.densities += p.saturated.densities;
    result->saturated.colors += p.saturated.colors;
    sums.loss += p.sums.loss;
    sums.squared_error += p.sums.squared_error;
    sums.color_rays += p.sums.color_rays;
    sums.solid_rays += p.sums.solid_rays;
    sums.shown += p.sums.shown;
    sums.log_share += p.sums.log_share;
    gradient_segments_.push_back(p.gradient);
  }
  for (const SurfacePoints& points : surface_points_) {
    if (points.count > 0) gradient_segments_.push_back(points.Gradient());
  }
  result->loss = sums.loss * static_cast<double>(ray_share);
  result->squared_error = sums.squared_error / (3.0 * static_cast<double>(std::max<int64_t>(1, sums.color_rays)));
  return sums;
}

bool FieldStep::SumNetworkGradients(field::OptimizerState& state) const {
  const auto network_size = static_cast<size_t>(field_.NetworkParameters());
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    for (size_t i = 0; i < network_size; ++i) state.network_gradient[i] += slot_gradients_[slot * network_size + i];
  }
  return kernel::AllFinite(state.network_gradient.data(), static_cast<int64_t>(network_size));
}

void FieldStep::ClipNetworkGradient(field::OptimizerState& state, StepResult& result) {
  double squares = 0.0;
  for (const float value : state.network_gradient) squares += static_cast<double>(value) * static_cast<double>(value);
  const double norm = std::sqrt(squares);
  result.gradient_norm = norm;
  double& running = state.network_gradient_norm;
  const double most = kMostOfRunningNorm * running;
  if (running > 0.0 && norm > most) {
    result.clipped = true;
    const auto factor = static_cast<float>(most / norm);
    for (float& value : state.network_gradient) value *= factor;
  }
  running = running > 0.0 ? running + kNormFollows * (std::min(norm, most) - running) : norm;
}

void FieldStep::TrainCodes(const RayBatch& batch, double learning_rate, AppearanceCodes& codes) const {
  for (size_t k = 0; k < batch.rays.size(); ++k) {
    const PixelRay& ray = batch.rays[k].ray;
    if (!ray.empty) codes.Add(ray.photo, code_gradients_.data() + k * codes.numbers());
  }
  codes.Step(learning_rate);
}

void FieldStep::UpdateRunningMeans(const LossSums& sums) {
  if (!luminance_.On() || !shared_.controls_mean) return;
  if (sums.color_rays > 0) {
    const double shown = sums.shown / (3.0 * static_cast<double>(sums.color_rays));
    state_.mean_shown += kMeansFollow * (shown - state_.mean_shown);
  }
  if (sums.solid_rays > 0) state_.mean_log_gain += kMeansFollow * (sums.log_share / static_cast<double>(sums.solid_rays) - state_.mean_log_gain);
}

void FieldStep::Infer(RayBatch& batch, const field::Parameters& parameters) {
  Encode(batch, parameters.grid);
  const PacketStep step{.batch = batch, .weights = field_.Prepare(parameters.networks), .grid = parameters.grid, .features = features_.data()};
  threads_.ParallelFor(static_cast<int64_t>(batch.packets.size()),
                       [&](int64_t k, int thread) { trainers_[static_cast<size_t>(thread)]->Infer(step, batch.packets[static_cast<size_t>(k)]); });
}

}  // namespace skyquilt::worker
