#include <algorithm>
#include <utility>

#include "core/field/hash_field.h"

namespace skyquilt::field {

void DensitySlope::Reserve(const HashField& field, int64_t n) {
  const size_t wanted = std::max<size_t>(kChunkStride, kernel::StrideFor(n));
  if (wanted <= stride) return;
  stride = wanted;
  const auto hidden_rows = static_cast<size_t>(field.config().hidden);
  const auto density_rows = static_cast<size_t>(field.DensityHiddenRows());
  const auto feature_rows = static_cast<size_t>(field.FeatureRows());
  const auto encoding_rows = static_cast<size_t>(field.encoding().OutputRows());
  buffer_.assign(stride * (3 + encoding_rows + 2 * feature_rows + 2 * density_rows + 2 * hidden_rows + kernel::kRowPad), 0.0F);
  float* next = buffer_.data();
  const auto take = [&](size_t rows) { return std::exchange(next, next + rows * stride); };
  gradient = take(3);
  feature_gradient = take(encoding_rows);
  features = take(feature_rows);
  hidden = take(density_rows);
  hidden_gradient = take(density_rows);
  tangent = take(feature_rows);
  for (float*& rows : hidden_tangent) rows = take(hidden_rows);
  ones = take(kernel::kRowPad);
}

void HashField::DensityGradient(const NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at, int64_t n,
                                DensitySlope& slope) const {
  slope.Reserve(*this, n);
  const size_t stride = slope.stride;
  const int64_t padded = kernel::Padded(n);
  const auto clear_rest = [&](float* rows, int count) {
    for (int row = 0; row < count; ++row)
      std::fill(rows + static_cast<size_t>(row) * stride + n, rows + static_cast<size_t>(row) * stride + padded, 0.0F);
  };
  EncodeSerial(grid, at, n, slope.features, stride);
  clear_rest(slope.features, FeatureRows());
  const size_t layer_size = static_cast<size_t>(config_.hidden) * stride;
  const auto hidden = [&](size_t layer) { return slope.hidden + layer * layer_size; };
  const auto hidden_gradient = [&](size_t layer) { return slope.hidden_gradient + layer * layer_size; };
  kernel::Dense(weights.layer[0].data(), config_.hidden, layers_[0].inputs, slope.features, stride, padded, true, hidden(0), stride);
  for (size_t l = 1; l < DensityOutput(); ++l) {
    kernel::Dense(weights.layer[l].data(), config_.hidden, config_.hidden, hidden(l - 1), stride, padded, true, hidden(l), stride);
  }
  // Back from the log density, whose weights are the first row of the last layer.
  size_t below = DensityOutput() - 1;
  const float* const to_density = weights.layer[DensityOutput()].data();
  for (int row = 0; row < config_.hidden; ++row) {
    const float* const gate = hidden(below) + static_cast<size_t>(row) * stride;
    float* const out = hidden_gradient(below) + static_cast<size_t>(row) * stride;
    for (int64_t s = 0; s < padded; ++s) out[s] = gate[s] > 0.0F ? to_density[row] : 0.0F;
  }
  for (; below > 0; --below) {
    kernel::DenseGated(weights.transposed[below].data(), config_.hidden, config_.hidden, hidden_gradient(below), stride, padded, hidden(below - 1),
                       stride, hidden_gradient(below - 1), stride);
  }
  // The rows after the encoding do not depend on the position.
  kernel::Dense(weights.transposed[0].data(), encoding_->OutputRows(), config_.hidden, hidden_gradient(0), stride, padded, false,
                slope.feature_gradient, stride);
  for (size_t axis = 0; axis < 3; ++axis) std::fill_n(slope.gradient + axis * stride, padded, 0.0F);
  for (int part = 0; part < encoding_->parts(); ++part) {
    encoding_->Slope(part, grid.data() + encoding_->Offset(part), at, n,
                     slope.feature_gradient + static_cast<size_t>(encoding_->FirstRow(part)) * stride, stride, slope.gradient, stride);
  }
}

// With the tangents p_0 = J along and p_l = D_l W_l p_{l-1}, and d_l the gradient before the ReLU of layer l, the loss grows by
//   d_l . W_l p_{l-1} = w_out . p_last,   so dL/dW_l += d_l p_{l-1}^T,  dL/dw_out += p_last,  dL/dp_0 = W_1^T d_1 (slope.feature_gradient).
void HashField::DensityGradientBackward(const NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at, int64_t n,
                                        const float* along, DensitySlope& slope, float* network_gradient) const {
  const size_t stride = slope.stride;
  const int64_t padded = kernel::Padded(n);
  std::fill_n(slope.tangent, static_cast<size_t>(FeatureRows()) * stride, 0.0F);
  for (int part = 0; part < encoding_->parts(); ++part) {
    encoding_->Tangent(part, grid.data() + encoding_->Offset(part), at, n, along, stride,
                       slope.tangent + static_cast<size_t>(encoding_->FirstRow(part)) * stride, stride);
  }
  const float* below = slope.tangent;
  int inputs = layers_[0].inputs;
  const size_t layer_size = static_cast<size_t>(config_.hidden) * stride;
  for (size_t l = 0; l < DensityOutput(); ++l) {
    float* const next = slope.hidden_tangent[l % 2];
    kernel::DenseWeightGradient(slope.hidden_gradient + l * layer_size, stride, config_.hidden, below, stride, inputs, padded,
                                network_gradient + network_offsets_[l]);
    kernel::DenseGated(weights.layer[l].data(), config_.hidden, inputs, below, stride, padded, slope.hidden + l * layer_size, stride, next, stride);
    below = next;
    inputs = config_.hidden;
  }
  std::fill_n(slope.ones, padded, 0.0F);
  std::fill_n(slope.ones, n, 1.0F);
  kernel::DenseWeightGradient(slope.ones, stride, kernel::kRowPad, below, stride, config_.hidden, padded,
                              network_gradient + network_offsets_[DensityOutput()]);
}

}  // namespace skyquilt::field
