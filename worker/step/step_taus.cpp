#include "worker/step/step_taus.h"

#include <algorithm>

#include "worker/step/packet_density.h"

namespace skyquilt::worker {

void StepTaus::Evaluate(const field::HashField& field, const field::NetworkWeights& weights, std::span<const float> grid, const kernel::Positions& at,
                        int64_t n, float* out) {
  // Tables are read for many samples at a time, the networks work on chunks.
  constexpr int64_t kRun = 16 * field::kChunk;
  geometry_.resize(static_cast<size_t>(field::kGeometryRows) * field::kChunkStride);
  hidden_.resize(static_cast<size_t>(field.DensityHiddenRows()) * field::kChunkStride);
  for (int64_t begin = 0; begin < n; begin += kRun) {
    const int64_t count = std::min(kRun, n - begin);
    const int64_t padded = kernel::Padded(count);
    const size_t stride = kernel::StrideFor(count);
    features_.assign(static_cast<size_t>(field.FeatureRows()) * stride, 0.0F);
    field.EncodeSerial(grid, at.From(begin), count, features_.data(), stride);
    for (int64_t s = 0; s < padded; s += field::kChunk) {
      const int64_t size = std::min<int64_t>(field::kChunk, padded - s);
      field.Density(weights, features_.data() + s, stride, size, hidden_.data(), field::kChunkStride, geometry_.data(), field::kChunkStride);
      field.StepTau(geometry_.data(), size, kMaxLogTau, geometry_.data());
      std::copy_n(geometry_.begin(), std::min(size, count - s), out + begin + s);
    }
  }
}

}  // namespace skyquilt::worker
