#include "worker/samplers/proposal_network.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "worker/samplers/ray_bins.h"

namespace skyquilt::worker {
namespace {

// As nerfacto's, but for the resolution, which follows the field's, and a sixth level, because kernels take four rows at a time.
constexpr int kLevels = 6, kFeatures = 2, kHidden = 16, kLog2TableSize = 17;
// Buffers that network gradients are summed in: run k in buffer k modulo this, so that sums do not depend on threads.
constexpr size_t kGradientSlots = 16;

field::FieldConfig ConfigOf(const field::FieldConfig& of_field, double resolution_share) {
  field::FieldConfig config;
  config.grid = of_field.grid;
  config.grid.levels = kLevels;
  config.grid.features = kFeatures;
  config.grid.log2_table_size = kLog2TableSize;
  config.grid.finest_resolution = std::max(config.grid.base_resolution, resolution_share * of_field.grid.finest_resolution);
  config.hidden = kHidden;
  config.sh_degree = 1;
  config.density_bias = of_field.density_bias;
  return config;
}

}  // namespace

ProposalNetwork::ProposalNetwork(const field::FieldConfig& of_field, double resolution_share, double half_width, base::ThreadPool& threads)
    : field_(ConfigOf(of_field, resolution_share)),
      half_width_(half_width),
      threads_(threads),
      optimizer_(field_, threads),
      scratch_(static_cast<size_t>(threads.size())) {
  parameters_.Allocate(field_);
  state_.Allocate(field_);
}

std::vector<ProposalNetwork::Run> ProposalNetwork::Runs(std::span<const Found> groups) {
  std::vector<Run> runs;
  size_t floats = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    const auto bins = static_cast<int64_t>(groups[g].own->bins);
    const auto rays = static_cast<int64_t>(groups[g].own->tau.size()) / bins;
    const int64_t together = std::max<int64_t>(1, field::kChunk / bins);
    for (int64_t first = 0; first < rays; first += together) {
      Run run{g, first, std::min(together, rays - first)};
      run.stride = kernel::StrideFor(run.rays * bins);
      run.features = floats;
      floats += run.stride * static_cast<size_t>(field_.FeatureRows());
      runs.push_back(run);
    }
  }
  features_.resize(std::max(features_.size(), floats));
  return runs;
}

double ProposalNetwork::LearnRun(const Found& found, const Run& run, float ray_share, Scratch& s, float* network_gradient) {
  const ProposalBins& own = *found.own;
  const auto bins = static_cast<size_t>(own.bins);
  const auto first = static_cast<size_t>(run.first_ray) * bins;
  const int64_t n = run.rays * own.bins, padded = kernel::Padded(n);
  float* const features = features_.data() + run.features;
  s.a.Reserve(field_, padded);
  field_.EncodeSerial(parameters_.grid, kernel::Positions{own.x.data(), own.y.data(), own.z.data()}.From(static_cast<int64_t>(first)), n, features,
                      run.stride);
  for (int row = 0; row < field_.FeatureRows(); ++row) {
    float* const values = features + static_cast<size_t>(row) * run.stride;
    std::fill(values + n, values + padded, 0.0F);
  }
  field_.Density(weights_, features, run.stride, padded, s.a.density_hidden, s.a.stride, s.a.geometry(), s.a.stride);
  std::fill_n(s.a.geometry_gradient, static_cast<size_t>(field::kGeometryRows) * s.a.stride, 0.0F);
  s.mass.resize(bins);
  s.weights.resize(bins);
  double loss = 0.0;
  for (int64_t r = 0; r < run.rays; ++r) {
    const auto ray = static_cast<size_t>(run.first_ray + r);
    const auto field_bins = static_cast<size_t>(found.bins);
    BlurredWeights(field_bins, found.edges.data() + ray * (field_bins + 1), found.weights.data() + ray * field_bins, half_width_, bins,
                   own.edges.data() + ray * (bins + 1), s.blur, s.mass.data());
    const std::span<const float> tau(own.tau.data() + ray * bins, bins);
    const float transmittance = WeightsOfTaus(tau, s.weights.data());
    s.weight_gradient.assign(bins, 0.0F);
    loss += static_cast<double>(AddInterlevelLoss(ray_share, bins, s.mass.data(), s.weights.data(), s.weight_gradient.data()));
    // d tau / d log density = tau.
    float* const gradient = s.a.geometry_gradient + static_cast<size_t>(r) * bins;
    WeightsBackward<float>(s.weights, transmittance, s.weight_gradient.data(), gradient);
    for (size_t i = 0; i < bins; ++i) gradient[i] *= tau[i];
  }
  field_.DensityBackward(weights_, s.a, features, run.stride, padded, network_gradient);
  for (int row = 0; row < field_.FeatureRows(); ++row) {
    if (!kernel::AllFinite(features + static_cast<size_t>(row) * run.stride, n)) return std::numeric_limits<double>::quiet_NaN();
  }
  return loss;
}

double ProposalNetwork::Learn(std::span<const Found> groups, double learning_rate) {
  const std::vector<Run> runs = Runs(groups);
  int64_t rays = 0;
  for (const Run& run : runs) rays += run.rays;
  if (rays == 0) return 0.0;
  const float ray_share = 1.0F / static_cast<float>(rays);
  const auto network_size = static_cast<size_t>(field_.NetworkParameters());
  slot_gradients_.assign(network_size * kGradientSlots, 0.0F);
  std::vector<double> losses(runs.size(), 0.0);
  threads_.ParallelFor(static_cast<int64_t>(kGradientSlots), [&](int64_t slot, int thread) {
    float* const network_gradient = slot_gradients_.data() + static_cast<size_t>(slot) * network_size;
    for (size_t k = static_cast<size_t>(slot); k < runs.size(); k += kGradientSlots) {
      losses[k] = LearnRun(groups[runs[k].group], runs[k], ray_share, scratch_[static_cast<size_t>(thread)], network_gradient);
    }
  });
  double loss = 0.0;
  for (const double of_run : losses) loss += of_run;
  for (size_t slot = 0; slot < kGradientSlots; ++slot) {
    for (size_t i = 0; i < network_size; ++i) state_.network_gradient[i] += slot_gradients_[slot * network_size + i];
  }
  if (!std::isfinite(loss) || !kernel::AllFinite(state_.network_gradient.data(), static_cast<int64_t>(network_size))) {
    std::fill(state_.network_gradient.begin(), state_.network_gradient.end(), 0.0F);
    return loss;
  }
  std::vector<kernel::Positions> places;
  places.reserve(groups.size());
  for (const Found& found : groups) places.push_back({found.own->x.data(), found.own->y.data(), found.own->z.data()});
  std::vector<field::FeatureGradient> segments;
  for (const Run& run : runs) {
    const int64_t bins = groups[run.group].own->bins;
    segments.push_back({.begin = run.first_ray * bins,
                        .count = run.rays * bins,
                        .gradient = features_.data() + run.features,
                        .stride = run.stride,
                        .at = &places[run.group]});
  }
  optimizer_.Update({}, segments, learning_rate, 0.0, parameters_, state_);
  return loss;
}

}  // namespace skyquilt::worker
