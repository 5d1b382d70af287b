// Baseline: the vector-matrix factorisation of TensoRF (Chen et al. 2022, eq. 3 and section 4). For each axis w with the other two axes u and v,
//   feature_c(x) = plane_c(u, v) * line_c(w)
// Planes are interpolated bilinearly, lines linearly; the channels c of the three axes follow each other.
// The number of channels per axis is the multiple of four nearest to a third of the features of a hash grid of the same configuration. The
// resolution, equal along all axes, is the largest that needs no more parameters than that hash grid and is not finer than its finest level. A part
// has kGroup channels of one axis: plane entries (index u + v * points along u), then line entries, of kGroup floats each.
#pragma once

#include "core/encoding/encoding.h"

namespace skyquilt::encoding {

class PlaneFactors : public Encoding {
 public:
  static constexpr int kGroup = 4;  // channels per part

  // Throws std::invalid_argument with the member that is out of range.
  explicit PlaneFactors(const HashGridConfig& config);

  // Resolution and points per axis; `entries` is not used.
  const kernel::GridLevel& lattice() const { return lattice_; }
  // Axes of a part, 0 to 2: {u, v} of its plane, w of its line.
  struct Axes {
    int u, v, w;
  };
  Axes AxesOf(int part) const;
  int64_t PlaneEntries(int part) const;

  Kind kind() const override { return Kind::kPlanes; }
  // Planes are initialised like other tables, lines with 1: at first the features equal the planes, and gradients reach the planes unchanged. The
  // paper's initialisation (normal, standard deviation 0.1, for both) needs its coarse-to-fine schedule and many thousand steps: products of noise
  // must be unlearned, and small factors learn slowly.
  void Initialize(base::Random& random, std::span<float> parameters) const override;
  void Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const override;
  void Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                float* table_gradient, uint8_t* touched) const override;

 private:
  struct Block;
  // Of position j of the samples begin .. begin + count; the weights of the plane include the sample's footprint and the share of the position.
  void FindEntries(int part, const kernel::Positions& at, int j, int64_t begin, int count, Block& block) const;

  int groups_;  // parts per axis
  kernel::GridLevel lattice_;
};

}  // namespace skyquilt::encoding
