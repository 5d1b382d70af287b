#include "core/encoding/frequency.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::encoding {
namespace {

constexpr int kMaxOctaves = 16;

constexpr int64_t kTurnsBlock = 256;

inline float Inside(float position, float extent) {
  return position > 0.0F ? std::min(position, extent) : 0.0F;
}

}  // namespace

Frequency::Frequency(const HashGridConfig& config) {
  config.Check();
  for (int axis = 0; axis < 3; ++axis) extent_[axis] = static_cast<float>(config.extent[axis]);
  const int octaves = std::clamp(1 + static_cast<int>(std::lround(std::log2(0.5 * config.finest_resolution))), 1, kMaxOctaves);
  AddPart(4, 0);
  for (int octave = 0; octave < octaves; ++octave) AddPart(octave + 1 < octaves ? 6 : kernel::PaddedRows(OutputRows() + 6) - OutputRows(), 0);
}

void Frequency::Forward(int part, const float* /*table*/, const float* x, const float* y, const float* z, int64_t n, float* out,
                        size_t out_stride) const {
  const float* const position[3] = {x, y, z};
  const int rows = FirstRow(part + 1) - FirstRow(part);
  const auto row = [&](int i) { return out + static_cast<size_t>(i) * out_stride; };
  if (part == 0) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int64_t s = 0; s < n; ++s) row(axis)[s] = Inside(position[axis][s], extent_[axis]);
    }
    std::fill_n(row(3), n, 1.0F);
    return;
  }
  const auto cycles_per_unit = static_cast<float>(1 << (part - 1));
  float turns[kTurnsBlock], sine[kTurnsBlock], cosine[kTurnsBlock];
  for (int axis = 0; axis < 3; ++axis) {
    for (int64_t begin = 0; begin < n; begin += kTurnsBlock) {
      const int64_t count = std::min(kTurnsBlock, n - begin);
      for (int64_t s = 0; s < count; ++s) turns[s] = cycles_per_unit * Inside(position[axis][begin + s], extent_[axis]);
      const int64_t padded = kernel::Padded(count);
      std::fill(turns + count, turns + padded, 0.0F);
      kernel::SineCosine(turns, padded, sine, cosine);
      std::copy_n(sine, count, row(axis) + begin);
      std::copy_n(cosine, count, row(axis + 3) + begin);
    }
  }
  for (int i = 6; i < rows; ++i) std::fill_n(row(i), n, 0.0F);
}

void Frequency::Backward(int /*part*/, const float* /*table*/, const float* /*x*/, const float* /*y*/, const float* /*z*/, int64_t /*n*/,
                         const float* /*out_gradient*/, size_t /*out_stride*/, float* /*table_gradient*/, uint8_t* /*touched*/) const {}

}  // namespace skyquilt::encoding
