// Baseline: the positional encoding of NeRF (Mildenhall et al. 2020, eq. 4). Features are the coordinates and, for octaves l = 0 .. L-1 and each
// coordinate p in [0, 1],
//   sin(2 pi 2^l p), cos(2 pi 2^l p)
// which equal the paper's, up to sign, for a box of edge 2 about the origin. It has no parameters, so the networks must learn everything; the paper's
// network has eight layers of width 256. Our networks have no biases, so a row of ones is added to the coordinates.
// Footprints damp the octaves (mip-NeRF, Barron et al. 2021, eq. 13).
// The finest octave has about half as many cycles per unit as the finest level of a hash grid of the same configuration has cells; L is at most 16.
// Part 0: rows x, y, z, 1. Part l + 1: octave l, sines of x, y, z, then cosines. Zero rows after the last pad to a multiple of kernel::kRowPad.
#pragma once

#include "core/encoding/encoding.h"

namespace skyquilt::encoding {

class Frequency : public Encoding {
 public:
  // Throws std::invalid_argument with the member that is out of range.
  explicit Frequency(const HashGridConfig& config);

  int octaves() const { return parts() - 1; }

  Kind kind() const override { return Kind::kFrequency; }
  // Sines and cosines have an error of at most 2e-7.
  void Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const override;
  // Does nothing: there are no parameters.
  void Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                float* table_gradient, uint8_t* touched) const override;

 private:
  // Adds the share of one position per sample, at.x to at.z.
  void AddPosition(int part, const kernel::Positions& at, const float* sharpness, int64_t n, float* out, size_t out_stride) const;
  float extent_[3];
};

}  // namespace skyquilt::encoding
