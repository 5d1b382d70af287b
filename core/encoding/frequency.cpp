#include "core/encoding/frequency.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::encoding {
namespace {

constexpr int kMaxOctaves = 16;

constexpr int64_t kTurnsBlock = 256;

inline float Inside(float position, float extent) {
  return position > 0.0F ? std::min(position, extent) : 0.0F;
}

// Mean of a wave over a footprint, relative to its value at the centre: exp(-(2 pi f s)^2 / 2) (Barron et al. 2021, mip-NeRF, eq. 13).
float Damping(float sharpness, float cycles_per_unit) {
  const float ratio = 0.5F * std::numbers::pi_v<float> * cycles_per_unit / sharpness;  // 2 pi f s / sqrt(2), s = 1 / (sqrt(8) sharpness)
  return std::isnan(ratio) ? 1.0F : std::exp(-ratio * ratio);
}

}  // namespace

Frequency::Frequency(const HashGridConfig& config) {
  config.Check();
  for (int axis = 0; axis < 3; ++axis) extent_[axis] = static_cast<float>(config.extent[axis]);
  const int octaves = std::clamp(1 + static_cast<int>(std::lround(std::log2(0.5 * config.finest_resolution))), 1, kMaxOctaves);
  AddPart(4, 0);
  for (int octave = 0; octave < octaves; ++octave) AddPart(octave + 1 < octaves ? 6 : kernel::PaddedRows(OutputRows() + 6) - OutputRows(), 0);
}

void Frequency::Forward(int part, const float* /*table*/, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const {
  const int rows = FirstRow(part + 1) - FirstRow(part);
  const auto row = [&](int i) { return out + static_cast<size_t>(i) * out_stride; };
  for (int i = 0; i < rows; ++i) std::fill_n(row(i), n, part == 0 && i == 3 ? 1.0F : 0.0F);
  for (int j = 0; j < at.points; ++j)
    AddPosition(part, at.From(static_cast<int64_t>(static_cast<size_t>(j) * at.plane)), at.sharpness, n, out, out_stride);
}

void Frequency::AddPosition(int part, const kernel::Positions& at, const float* sharpness, int64_t n, float* out, size_t out_stride) const {
  const float* const position[3] = {at.x, at.y, at.z};
  const float share = 1.0F / static_cast<float>(at.points);
  const auto row = [&](int i) { return out + static_cast<size_t>(i) * out_stride; };
  if (part == 0) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int64_t s = 0; s < n; ++s) row(axis)[s] += share * Inside(position[axis][s], extent_[axis]);
    }
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
      for (int64_t s = 0; s < count; ++s) {
        const float weight = sharpness != nullptr ? share * Damping(sharpness[begin + s], cycles_per_unit) : share;
        row(axis)[begin + s] += weight * sine[s];
        row(axis + 3)[begin + s] += weight * cosine[s];
      }
    }
  }
}

void Frequency::Backward(int /*part*/, const float* /*table*/, const kernel::Positions& /*at*/, int64_t /*n*/, const float* /*out_gradient*/,
                         size_t /*out_stride*/, float* /*table_gradient*/, uint8_t* /*touched*/) const {}

}  // namespace skyquilt::encoding
