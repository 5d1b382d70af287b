// Baseline: one dense voxel grid with trilinear interpolation (Sun et al. 2022, DVGO, section 4). It has as many channels as a hash grid of the same
// configuration has features; its resolution is the largest that needs no more parameters than that hash grid and is not finer than its finest level.
// A part has `features` channels of every lattice point.
#pragma once

#include "core/encoding/encoding.h"

namespace skyquilt::encoding {

class VoxelGrid : public Encoding {
 public:
  // Throws std::invalid_argument with the member that is out of range.
  explicit VoxelGrid(const HashGridConfig& config);

  // The lattice, the same for every part.
  const kernel::GridLevel& lattice() const { return lattice_; }

  Kind kind() const override { return Kind::kVoxels; }
  void Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const override;
  void Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                float* table_gradient, uint8_t* touched) const override;
  const kernel::GridLevel* InterpolatesIn(int /*part*/) const override { return &lattice_; }

 private:
  int features_;
  kernel::GridLevel lattice_;
};

}  // namespace skyquilt::encoding
