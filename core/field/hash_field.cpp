#include "core/field/hash_field.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/encoding/spherical_harmonics.h"

namespace skyquilt::field {
namespace {

constexpr int64_t kEncodeStretch = 4096;

void Require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument("field: " + what);
}

}  // namespace

HashField::HashField(const FieldConfig& config) : config_(config), grid_(config.grid) {
  Require(config.hidden >= 4 && config.hidden <= 256 && config.hidden % 4 == 0, "hidden must be a multiple of 4 in 4..256");
  Require(config.color_hidden_layers >= 1 && config.color_hidden_layers <= 3, "color_hidden_layers must be 1..3");
  Require(config.sh_degree >= 1 && config.sh_degree <= 4, "sh_degree must be 1..4");
  Require(config.color_range > 0.0 && std::isfinite(config.color_range), "color_range must be positive");
  color_inputs_ = kGeometryRows + kernel::PaddedRows(config.sh_degree * config.sh_degree);
  layers_.push_back({config.hidden, kernel::PaddedRows(FeatureRows())});
  layers_.push_back({kGeometryRows, config.hidden});
  layers_.push_back({config.hidden, color_inputs_});
  for (int l = 1; l < config.color_hidden_layers; ++l) layers_.push_back({config.hidden, config.hidden});
  layers_.push_back({kColorRows, config.hidden});
  Require(FeatureRows() % kernel::kRowPad == 0, "levels * features must be a multiple of 4");
  network_offsets_.push_back(0);
  for (const Layer& layer : layers_) network_offsets_.push_back(network_offsets_.back() + static_cast<int64_t>(layer.outputs) * layer.inputs);
}

void HashField::Initialize(base::Random& random, std::span<float> grid, std::span<float> networks) const {
  for (float& value : grid) value = static_cast<float>(random.Uniform(-1e-4, 1e-4));
  for (size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    const double limit = std::sqrt(6.0 / (layer.outputs + layer.inputs));
    float* weights = networks.data() + network_offsets_[l];
    for (int o = 0; o < layer.outputs; ++o) {
      for (int i = 0; i < layer.inputs; ++i) {
        const bool padding = l + 1 == layers_.size() && o >= 3;
        weights[o * layer.inputs + i] = padding ? 0.0F : static_cast<float>(random.Uniform(-limit, limit));
      }
    }
  }
}

NetworkWeights HashField::Prepare(std::span<const float> networks) const {
  NetworkWeights weights;
  for (size_t l = 0; l < layers_.size(); ++l) {
    const auto [outputs, inputs] = layers_[l];
    const float* source = networks.data() + network_offsets_[l];
    weights.layer.emplace_back(source, source + static_cast<ptrdiff_t>(outputs) * inputs);
    std::vector<float> transposed(static_cast<size_t>(outputs) * static_cast<size_t>(inputs));
    for (int o = 0; o < outputs; ++o) {
      for (int i = 0; i < inputs; ++i) transposed[static_cast<size_t>(i * outputs + o)] = source[o * inputs + i];
    }
    weights.transposed.push_back(std::move(transposed));
  }
  return weights;
}

ChunkScratch HashField::MakeScratch() const {
  ChunkScratch scratch;
  const auto rows = [](int n) { return static_cast<size_t>(n) * kChunkStride; };
  for (auto& hidden : scratch.hidden) hidden.resize(rows(config_.hidden));
  for (auto& gradient : scratch.gradient) gradient.resize(rows(std::max(config_.hidden, kGeometryRows)));
  scratch.color_in.resize(rows(color_inputs_));
  scratch.color_in_gradient.resize(rows(color_inputs_));
  return scratch;
}

void HashField::Encode(std::span<const float> grid, const float* x, const float* y, const float* z, int64_t n, float* features, size_t stride,
                       base::ThreadPool& threads) const {
  const int64_t stretches = (n + kEncodeStretch - 1) / kEncodeStretch;
  // Level by level, so that one level's table stays in cache while all samples pass.
  threads.ParallelFor(stretches * grid_.levels(), [&](int64_t task, int) {
    const int l = static_cast<int>(task / stretches);
    const int64_t begin = (task % stretches) * kEncodeStretch;
    const int64_t count = std::min(kEncodeStretch, n - begin);
    kernel::HashForward(grid_.level(l), grid_.features(), grid.data() + grid_.Offset(l), x + begin, y + begin, z + begin, count,
                        features + static_cast<size_t>(l * grid_.features()) * stride + begin, stride);
  });
}

void HashField::EncodeSerial(std::span<const float> grid, const float* x, const float* y, const float* z, int64_t n, float* features,
                             size_t stride) const {
  for (int l = 0; l < grid_.levels(); ++l) {
    kernel::HashForward(grid_.level(l), grid_.features(), grid.data() + grid_.Offset(l), x, y, z, n,
                        features + static_cast<size_t>(l * grid_.features()) * stride, stride);
  }
}

void HashField::Density(const NetworkWeights& weights, const float* features, size_t feature_stride, int64_t n, ChunkScratch& scratch,
                        float* geometry, size_t geometry_stride) const {
  kernel::Dense(weights.layer[0].data(), config_.hidden, layers_[0].inputs, features, feature_stride, n, true, scratch.hidden[0].data(),
                kChunkStride);
  kernel::Dense(weights.layer[1].data(), kGeometryRows, config_.hidden, scratch.hidden[0].data(), kChunkStride, n, false, geometry, geometry_stride);
}

void HashField::FillColorInput(const float* geometry, size_t geometry_stride, const float* direction, size_t direction_stride, int64_t n,
                               ChunkScratch& scratch) const {
  for (int r = 0; r < kGeometryRows; ++r) {
    std::memcpy(scratch.color_in.data() + static_cast<size_t>(r) * kChunkStride, geometry + static_cast<size_t>(r) * geometry_stride,
                static_cast<size_t>(n) * sizeof(float));
  }
  float* sh_rows = scratch.color_in.data() + static_cast<size_t>(kGeometryRows) * kChunkStride;
  const int sh_count = config_.sh_degree * config_.sh_degree;
  float sh[16];
  for (int64_t s = 0; s < n; ++s) {
    encoding::SphericalHarmonics(direction[s], direction[direction_stride + static_cast<size_t>(s)],
                                 direction[2 * direction_stride + static_cast<size_t>(s)], config_.sh_degree, sh);
    for (int k = 0; k < sh_count; ++k) sh_rows[static_cast<size_t>(k) * kChunkStride + static_cast<size_t>(s)] = sh[k];
  }
}

void HashField::Color(const NetworkWeights& weights, const float* geometry, size_t geometry_stride, const float* direction, size_t direction_stride,
                      int64_t n, ChunkScratch& scratch, float* color_raw, size_t color_stride) const {
  FillColorInput(geometry, geometry_stride, direction, direction_stride, n, scratch);
  const float* in = scratch.color_in.data();
  int inputs = color_inputs_;
  for (int l = 0; l < config_.color_hidden_layers; ++l) {
    float* out = scratch.hidden[1 + l].data();
    kernel::Dense(weights.layer[static_cast<size_t>(2 + l)].data(), config_.hidden, inputs, in, kChunkStride, n, true, out, kChunkStride);
    in = out;
    inputs = config_.hidden;
  }
  kernel::Dense(weights.layer.back().data(), kColorRows, config_.hidden, in, kChunkStride, n, false, color_raw, color_stride);
}

void HashField::Backward(const NetworkWeights& weights, const float* features, size_t feature_stride, const float* direction, size_t direction_stride,
                         int64_t n, const float* color_gradient, size_t color_stride, const float* log_density_gradient, ChunkScratch& scratch,
                         float* feature_gradient, size_t feature_gradient_stride, float* network_gradient) const {
  const size_t last = layers_.size() - 1;
  float geometry[static_cast<size_t>(kGeometryRows) * kChunkStride];
  float color_raw[static_cast<size_t>(kColorRows) * kChunkStride];
  Density(weights, features, feature_stride, n, scratch, geometry, kChunkStride);
  Color(weights, geometry, kChunkStride, direction, direction_stride, n, scratch, color_raw, kChunkStride);

  const auto gradient_of = [&](size_t layer) { return network_gradient + network_offsets_[layer]; };
  // Colour network, from its output to [geometry, SH].
  const int hidden_layers = config_.color_hidden_layers;
  const float* top = scratch.hidden[hidden_layers].data();
  kernel::DenseWeightGradient(color_gradient, color_stride, kColorRows, top, kChunkStride, config_.hidden, n, gradient_of(last));
  float* current = scratch.gradient[0].data();
  float* next = scratch.gradient[1].data();
  kernel::Dense(weights.transposed[last].data(), config_.hidden, kColorRows, color_gradient, color_stride, n, false, current, kChunkStride);
  for (int l = hidden_layers - 1; l >= 0; --l) {
    kernel::ReluBackward(scratch.hidden[1 + l].data(), kChunkStride, config_.hidden, n, current, kChunkStride);
    const bool first = l == 0;
    const float* in = first ? scratch.color_in.data() : scratch.hidden[l].data();
    const int inputs = first ? color_inputs_ : config_.hidden;
    const auto layer = static_cast<size_t>(2 + l);
    kernel::DenseWeightGradient(current, kChunkStride, config_.hidden, in, kChunkStride, inputs, n, gradient_of(layer));
    if (first) {
      // Only the geometry rows go on: the direction has no parameters.
      kernel::Dense(weights.transposed[layer].data(), kGeometryRows, config_.hidden, current, kChunkStride, n, false,
                    scratch.color_in_gradient.data(), kChunkStride);
    } else {
      kernel::Dense(weights.transposed[layer].data(), config_.hidden, config_.hidden, current, kChunkStride, n, false, next, kChunkStride);
      std::swap(current, next);
    }
  }
  float* geometry_gradient = scratch.color_in_gradient.data();
  for (int64_t s = 0; s < n; ++s) geometry_gradient[s] += log_density_gradient[s];
  // Density network.
  kernel::DenseWeightGradient(geometry_gradient, kChunkStride, kGeometryRows, scratch.hidden[0].data(), kChunkStride, config_.hidden, n,
                              gradient_of(1));
  kernel::Dense(weights.transposed[1].data(), config_.hidden, kGeometryRows, geometry_gradient, kChunkStride, n, false, current, kChunkStride);
  kernel::ReluBackward(scratch.hidden[0].data(), kChunkStride, config_.hidden, n, current, kChunkStride);
  kernel::DenseWeightGradient(current, kChunkStride, config_.hidden, features, feature_stride, layers_[0].inputs, n, gradient_of(0));
  kernel::Dense(weights.transposed[0].data(), layers_[0].inputs, config_.hidden, current, kChunkStride, n, false, feature_gradient,
                feature_gradient_stride);
}

}  // namespace skyquilt::field
