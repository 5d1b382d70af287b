#include "core/field/hash_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/encoding/spherical_harmonics.h"

namespace skyquilt::field {
namespace {

void Require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument("field: " + what);
}

}  // namespace

HashField::HashField(const FieldConfig& config) : config_(config), encoding_(encoding::MakeEncoding(config.encoding, config.grid)) {
  Require(config.hidden >= 4 && config.hidden <= 256 && config.hidden % 4 == 0, "hidden must be a multiple of 4 in 4..256");
  Require(config.density_hidden_layers >= 1 && config.density_hidden_layers <= 8, "density_hidden_layers must be 1..8");
  Require(config.color_hidden_layers >= 1 && config.color_hidden_layers <= 3, "color_hidden_layers must be 1..3");
  Require(config.sh_degree >= 1 && config.sh_degree <= 4, "sh_degree must be 1..4");
  Require(config.color_range > 0.0 && std::isfinite(config.color_range), "color_range must be positive");
  Require(config.multisample == 0 || config.multisample == 1 || config.multisample == 4 || config.multisample == 6,
          "multisample must be 0, 1, 4 or 6");
  Require(!config.scale_features || config.Cones(), "scale_features needs multisample");
  Require(config.appearance >= 0 && config.appearance <= 32, "appearance must be 0..32");
  if (config.scale_features) scale_rows_ = kernel::PaddedRows(ScaledLevels());
  raw_shift_ = static_cast<float>(RawShift(config.density_activation, config.density_bias));
  layers_.push_back({config.hidden, FeatureRows()});
  for (int l = 1; l < config.density_hidden_layers; ++l) layers_.push_back({config.hidden, config.hidden});
  layers_.push_back({kGeometryRows, config.hidden});
  layers_.push_back({config.hidden, ColorInputRows()});
  for (int l = 1; l < config.color_hidden_layers; ++l) layers_.push_back({config.hidden, config.hidden});
  layers_.push_back({kColorRows, config.hidden});
  network_offsets_.push_back(0);
  for (const Layer& layer : layers_) network_offsets_.push_back(network_offsets_.back() + static_cast<int64_t>(layer.outputs) * layer.inputs);
}

void HashField::Initialize(base::Random& random, std::span<float> grid, std::span<float> networks) const {
  encoding_->Initialize(random, grid);
  for (size_t l = 0; l < layers_.size(); ++l) {
    const Layer& layer = layers_[l];
    const double limit = std::sqrt(6.0 / (layer.outputs + layer.inputs));
    float* weights = networks.data() + network_offsets_[l];
    for (int o = 0; o < layer.outputs; ++o) {
      for (int i = 0; i < layer.inputs; ++i) {
        const bool luminance = l + 1 == layers_.size() && o >= 3;
        weights[o * layer.inputs + i] = luminance ? 0.0F : static_cast<float>(random.Uniform(-limit, limit));
      }
    }
  }
  if (config_.luminance) {
    float* taps = networks.data() + LuminanceOffset();
    std::fill_n(taps, kLuminanceTaps, 1.0F / kLuminanceTaps);
    taps[kLuminanceTaps] = 0.0F;
  }
  if (config_.normal_head) InitializeNormalHead(random, networks.data() + NormalHeadOffset());
}

NetworkWeights HashField::Prepare(std::span<const float> networks) const {
  if (static_cast<int64_t>(networks.size()) != NetworkParameters()) {
    throw std::invalid_argument("the " + std::to_string(networks.size()) + " network parameters disagree with the configuration, which needs " +
                                std::to_string(NetworkParameters()));
  }
  NetworkWeights weights;
  for (size_t l = 0; l < layers_.size(); ++l) {
    const auto [outputs, inputs] = layers_[l];
    const float* source = networks.data() + network_offsets_[l];
    weights.layer.emplace_back(source, source + static_cast<ptrdiff_t>(outputs) * inputs);
    std::vector<float> transposed(static_cast<size_t>(outputs) * static_cast<size_t>(inputs));
    for (int o = 0; o < outputs; ++o) {
      for (int i = 0; i < inputs; ++i)
        transposed[static_cast<size_t>(i) * static_cast<size_t>(outputs) + static_cast<size_t>(o)] = source[o * inputs + i];
    }
    weights.transposed.push_back(std::move(transposed));
  }
  if (config_.luminance) std::copy_n(networks.data() + LuminanceOffset(), weights.luminance.size(), weights.luminance.begin());
  if (config_.normal_head) PrepareNormalHead(networks.data() + NormalHeadOffset(), weights);
  return weights;
}

void HashField::EncodeSerial(std::span<const float> grid, const kernel::Positions& at, int64_t n, float* features, size_t stride) const {
  for (int part = 0; part < encoding_->parts(); ++part) {
    encoding_->Forward(part, grid.data() + encoding_->Offset(part), at, n, features + static_cast<size_t>(encoding_->FirstRow(part)) * stride,
                       stride);
  }
  EncodeScales(at, n, features + static_cast<size_t>(encoding_->OutputRows()) * stride, stride);
}

void HashField::EncodeScales(const kernel::Positions& at, int64_t n, float* rows, size_t stride) const {
  for (int row = 0; row < scale_rows_; ++row) {
    float* const out = rows + static_cast<size_t>(row) * stride;
    if (at.sharpness == nullptr || row >= ScaledLevels()) {
      std::fill_n(out, n, 0.0F);
      continue;
    }
    const auto cells = static_cast<float>(encoding::LevelResolution(config_.grid, ScaledLevel(row)));
    kernel::FootprintHidden(at.sharpness, n, cells, out);
  }
}

void HashField::Density(const NetworkWeights& weights, const float* features, size_t feature_stride, int64_t n, float* hidden, size_t hidden_stride,
                        float* geometry, size_t geometry_stride) const {
  kernel::Dense(weights.layer[0].data(), config_.hidden, layers_[0].inputs, features, feature_stride, n, true, hidden, hidden_stride);
  const size_t layer_size = static_cast<size_t>(config_.hidden) * hidden_stride;
  for (size_t l = 1; l < DensityOutput(); ++l, hidden += layer_size) {
    kernel::Dense(weights.layer[l].data(), config_.hidden, config_.hidden, hidden, hidden_stride, n, true, hidden + layer_size, hidden_stride);
  }
  kernel::Dense(weights.layer[DensityOutput()].data(), kGeometryRows, config_.hidden, hidden, hidden_stride, n, false, geometry, geometry_stride);
}

void HashField::StepTau(const float* geometry, int64_t n, float max_log_tau, float* tau) const {
  switch (config_.density_activation) {
    case DensityActivation::kExp:
      return kernel::ExpShifted(geometry, n, raw_shift_, max_log_tau, tau);
    case DensityActivation::kSoftplus:
      return kernel::SoftplusShifted(geometry, n, raw_shift_, std::exp(max_log_tau), tau);
    case DensityActivation::kRelu:
      return kernel::ReluShifted(geometry, n, raw_shift_, std::exp(max_log_tau), tau);
  }
}

void HashField::EncodeDirection(const float direction[3], int64_t count, float* rows, size_t stride) const {
  float sh[16] = {};
  encoding::SphericalHarmonics(direction[0], direction[1], direction[2], config_.sh_degree, sh);
  const int directions = DirectionRows();
  for (int k = 0; k < directions; ++k) std::fill_n(rows + static_cast<size_t>(k) * stride, count, sh[k]);
  for (int k = directions; k < ColorInputRows() - kGeometryRows; ++k) std::fill_n(rows + static_cast<size_t>(k) * stride, count, 0.0F);
}

void HashField::DirectionBackward(const double direction[3], int64_t count, const float* rows_gradient, size_t stride, double gradient[3]) const {
  double by_row[16] = {};
  for (size_t k = 0; k < static_cast<size_t>(config_.sh_degree * config_.sh_degree); ++k) {
    const float* const row = rows_gradient + k * stride;
    for (int64_t s = 0; s < count; ++s) by_row[k] += static_cast<double>(row[s]);
  }
  encoding::SphericalHarmonicsBackward(direction[0], direction[1], direction[2], config_.sh_degree, by_row, gradient);
}

void HashField::EncodeAppearance(const float* code, int64_t count, float* rows, size_t stride) const {
  const auto first = static_cast<size_t>(AppearanceRow() - kGeometryRows);
  for (size_t k = 0; k < static_cast<size_t>(config_.appearance); ++k) std::fill_n(rows + (first + k) * stride, count, code[k]);
}

void HashField::FoldAppearance(std::span<const float> code, std::span<float> networks) const {
  Require(code.size() == static_cast<size_t>(config_.appearance), "a code must have as many numbers as the field's");
  Require(static_cast<int64_t>(networks.size()) == NetworkParameters(), "the network parameters disagree with the configuration");
  float sh[16] = {};
  encoding::SphericalHarmonics(0.0F, 0.0F, 1.0F, config_.sh_degree, sh);
  const auto [outputs, inputs] = layers_[ColorInput()];
  for (int o = 0; o < outputs; ++o) {
    float* row = networks.data() + network_offsets_[ColorInput()] + static_cast<ptrdiff_t>(o) * inputs;
    double sum = 0.0;
    for (size_t k = 0; k < code.size(); ++k) sum += static_cast<double>(row[static_cast<size_t>(AppearanceRow()) + k]) * static_cast<double>(code[k]);
    row[kGeometryRows] += static_cast<float>(sum / static_cast<double>(sh[0]));
  }
}

void HashField::Color(const NetworkWeights& weights, const float* color_in, size_t in_stride, int64_t n, float* const hidden[3], size_t hidden_stride,
                      float* color_raw, size_t color_stride) const {
  const float* in = color_in;
  int inputs = ColorInputRows();
  for (int l = 0; l < config_.color_hidden_layers; ++l) {
    kernel::Dense(weights.layer[ColorInput() + static_cast<size_t>(l)].data(), config_.hidden, inputs, in, in_stride, n, true, hidden[l],
                  hidden_stride);
    in = hidden[l];
    in_stride = hidden_stride;
    inputs = config_.hidden;
  }
  kernel::Dense(weights.layer.back().data(), kColorRows, config_.hidden, in, in_stride, n, false, color_raw, color_stride);
}

void HashField::Backward(const NetworkWeights& weights, Activations& a, float* features, size_t feature_stride, int64_t n, float* network_gradient,
                         const float* more_geometry_gradient) const {
  const size_t last = layers_.size() - 1;
  const size_t stride = a.stride;
  const int hidden = config_.hidden;
  const auto gradient_of = [&](size_t layer) { return network_gradient + network_offsets_[layer]; };
  // Colour network, from its output back to [geometry, SH].
  const int top = config_.color_hidden_layers - 1;
  float* current = a.hidden_gradient[0];
  float* next = a.hidden_gradient[1];
  kernel::DenseWeightGradient(a.color_gradient, stride, kColorRows, a.color_hidden[top], stride, hidden, n, gradient_of(last));
  kernel::DenseGated(weights.transposed[last].data(), hidden, kColorRows, a.color_gradient, stride, n, a.color_hidden[top], stride, current, stride);
  for (int l = top; l > 0; --l) {
    const size_t layer = ColorInput() + static_cast<size_t>(l);
    kernel::DenseWeightGradient(current, stride, hidden, a.color_hidden[l - 1], stride, hidden, n, gradient_of(layer));
    kernel::DenseGated(weights.transposed[layer].data(), hidden, hidden, current, stride, n, a.color_hidden[l - 1], stride, next, stride);
    std::swap(current, next);
  }
  kernel::DenseWeightGradient(current, stride, hidden, a.color_in, stride, ColorInputRows(), n, gradient_of(ColorInput()));
  // The direction has no parameters: its rows need a gradient only where poses are refined.
  kernel::Dense(weights.transposed[ColorInput()].data(), kGeometryRows, hidden, current, stride, n, false, a.geometry_gradient, stride);
  if (a.by_direction) {
    const float* by_direction = weights.transposed[ColorInput()].data() + static_cast<ptrdiff_t>(kGeometryRows) * hidden;
    kernel::Dense(by_direction, DirectionRows(), hidden, current, stride, n, false, a.direction_gradient, stride);
  }
  if (config_.appearance > 0) {
    const float* by_code = weights.transposed[ColorInput()].data() + static_cast<ptrdiff_t>(AppearanceRow()) * hidden;
    kernel::Dense(by_code, AppearanceRows(), hidden, current, stride, n, false, a.appearance_gradient, stride);
  }
  for (int64_t s = 0; s < n; ++s) a.geometry_gradient[s] += a.log_density_gradient[s];
  for (size_t row = 0; more_geometry_gradient != nullptr && row < kGeometryRows; ++row) {
    for (int64_t s = 0; s < n; ++s)
      a.geometry_gradient[row * stride + static_cast<size_t>(s)] += more_geometry_gradient[row * stride + static_cast<size_t>(s)];
  }
  DensityBackward(weights, a, features, feature_stride, n, network_gradient);
}

void HashField::DensityBackward(const NetworkWeights& weights, Activations& a, float* features, size_t feature_stride, int64_t n,
                                float* network_gradient) const {
  const size_t stride = a.stride;
  const int hidden = config_.hidden;
  const auto gradient_of = [&](size_t layer) { return network_gradient + network_offsets_[layer]; };
  float* current = a.hidden_gradient[0];
  float* next = a.hidden_gradient[1];
  const auto density_hidden = [&](size_t layer) { return a.density_hidden + layer * static_cast<size_t>(hidden) * stride; };
  size_t below = DensityOutput() - 1;
  kernel::DenseWeightGradient(a.geometry_gradient, stride, kGeometryRows, density_hidden(below), stride, hidden, n, gradient_of(DensityOutput()));
  kernel::DenseGated(weights.transposed[DensityOutput()].data(), hidden, kGeometryRows, a.geometry_gradient, stride, n, density_hidden(below), stride,
                     current, stride);
  for (; below > 0; --below) {
    kernel::DenseWeightGradient(current, stride, hidden, density_hidden(below - 1), stride, hidden, n, gradient_of(below));
    kernel::DenseGated(weights.transposed[below].data(), hidden, hidden, current, stride, n, density_hidden(below - 1), stride, next, stride);
    std::swap(current, next);
  }
  kernel::DenseWeightGradient(current, stride, hidden, features, feature_stride, layers_[0].inputs, n, gradient_of(0));
  // The rows after the encoding have no parameters.
  kernel::Dense(weights.transposed[0].data(), encoding_->OutputRows(), hidden, current, stride, n, false, features, feature_stride);
}

double HashField::ForwardFlops() const {
  const int hidden = config_.hidden;
  const int color_inputs = kGeometryRows + config_.sh_degree * config_.sh_degree + config_.appearance;
  return 2.0 * (FeatureRows() * hidden + (config_.density_hidden_layers - 1) * hidden * hidden + hidden * kGeometryRows + color_inputs * hidden +
                (config_.color_hidden_layers - 1) * hidden * hidden + hidden * 3);
}

double HashField::TrainFlops() const {
  // Twice as many again for the gradients of weights and inputs; the direction needs no gradient.
  return 3.0 * ForwardFlops() - 2.0 * config_.sh_degree * config_.sh_degree * config_.hidden;
}

void Activations::Reserve(const HashField& field, int64_t n) {
  const size_t wanted = std::max<size_t>(kChunkStride, kernel::StrideFor(n));
  if (wanted <= stride) return;
  stride = wanted;
  const auto hidden = static_cast<size_t>(field.config().hidden);
  const auto color_rows = static_cast<size_t>(field.ColorInputRows());
  const auto color_layers = static_cast<size_t>(field.config().color_hidden_layers);
  const auto code_rows = static_cast<size_t>(field.AppearanceRows());
  const auto direction_rows = static_cast<size_t>(field.DirectionRows());
  const auto density_rows = static_cast<size_t>(field.DensityHiddenRows());
  kept_rows = field.DensityHiddenRows() + kGeometryRows;
  buffer_.assign(
      stride * (density_rows + color_rows + color_layers * hidden + 2 * kColorRows + 1 + kGeometryRows + code_rows + direction_rows + 2 * hidden),
      0.0F);
  float* next = buffer_.data();
  const auto take = [&](size_t rows) { return std::exchange(next, next + rows * stride); };
  density_hidden = take(density_rows);
  color_in = take(color_rows);
  for (size_t l = 0; l < color_layers; ++l) color_hidden[l] = take(hidden);
  color_raw = take(kColorRows);
  color_gradient = take(kColorRows);
  log_density_gradient = take(1);
  geometry_gradient = take(kGeometryRows);
  if (code_rows > 0) appearance_gradient = take(code_rows);
  direction_gradient = take(direction_rows);
  for (float*& gradient : hidden_gradient) gradient = take(hidden);
}

}  // namespace skyquilt::field
