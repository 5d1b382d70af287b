#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/field/hash_field.h"

namespace skyquilt::field {
namespace {

constexpr size_t kUsedRows = 3;
constexpr size_t kInputs = kGeometryRows;

}  // namespace

// Xavier uniform; the row of padding stays zero, as its gradient is.
void HashField::InitializeNormalHead(base::Random& random, float* head) {
  const double limit = std::sqrt(6.0 / static_cast<double>(kUsedRows + kInputs));
  for (size_t i = 0; i < kUsedRows * kInputs; ++i) head[i] = static_cast<float>(random.Uniform(-limit, limit));
  std::fill(head + kUsedRows * kInputs, head + kNormalRows * kInputs, 0.0F);
}

void HashField::PrepareNormalHead(const float* head, NetworkWeights& weights) {
  weights.normal_head.assign(head, head + kNormalRows * kInputs);
  weights.normal_head_transposed.resize(weights.normal_head.size());
  for (size_t row = 0; row < kNormalRows; ++row) {
    for (size_t i = 0; i < kInputs; ++i) weights.normal_head_transposed[i * kNormalRows + row] = head[row * kInputs + i];
  }
}

void HashField::PredictNormals(const NetworkWeights& weights, const float* geometry, size_t geometry_stride, int64_t n, float* raw,
                               size_t raw_stride) const {
  SKYQUILT_CHECK(config_.normal_head, "a field without a normal head");
  kernel::Dense(weights.normal_head.data(), kNormalRows, kGeometryRows, geometry, geometry_stride, n, false, raw, raw_stride);
}

void HashField::NormalHeadBackward(const NetworkWeights& weights, const float* raw_gradient, size_t raw_stride, const float* geometry,
                                   size_t geometry_stride, int64_t n, float* geometry_gradient, float* network_gradient) const {
  SKYQUILT_CHECK(config_.normal_head, "a field without a normal head");
  kernel::DenseWeightGradient(raw_gradient, raw_stride, kNormalRows, geometry, geometry_stride, kGeometryRows, n,
                              network_gradient + NormalHeadOffset());
  if (geometry_gradient == nullptr) return;
  kernel::Dense(weights.normal_head_transposed.data(), kGeometryRows, kNormalRows, raw_gradient, raw_stride, n, false, geometry_gradient,
                geometry_stride);
}

}  // namespace skyquilt::field
