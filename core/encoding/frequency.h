// Positional encoding (Mildenhall et al. 2020, NeRF, eq. 4): the coordinates and, for octaves l = 0 .. L-1 and each coordinate p in [0, 1],
//   sin(2 pi 2^l p), cos(2 pi 2^l p)
// which are the paper's, up to sign, for a box of edge 2 about the origin. No parameters: everything has to be learned by the networks, which the
// authors made eight layers of 256 deep. As the field's networks have no biases, a row of ones stands beside the coordinates.
// The finest octave has about half as many cycles per unit as a hash grid of the same configuration has cells at its finest level, L at most 16.
// Parts: 0 is x, y, z, 1; part l + 1 is octave l, sines of x, y, z, then cosines. Rows of zeros behind the last fill up to kernel::kRowPad.
#pragma once

#include "core/encoding/encoding.h"

namespace skyquilt::encoding {

class Frequency : public Encoding {
 public:
  // Throws std::invalid_argument naming the field that is out of range.
  explicit Frequency(const HashGridConfig& config);

  int octaves() const { return parts() - 1; }

  Kind kind() const override { return Kind::kFrequency; }
  // Sines and cosines are off by at most 2e-7.
  void Forward(int part, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out, size_t out_stride) const override;
  // Nothing to do.
  void Backward(int part, const float* table, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient, size_t out_stride,
                float* table_gradient, uint8_t* touched) const override;

 private:
  float extent_[3];
};

}  // namespace skyquilt::encoding
