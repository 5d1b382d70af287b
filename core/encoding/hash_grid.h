// Multi-resolution hash grid (Mueller et al. 2022, eq. 2-4), the encoding used by default, over a box with edges `extent` (longest 1). The resolution
// of the levels grows geometrically from base to finest; a level whose lattice points fit into its table is dense. One part per level.
#pragma once

#include <vector>

#include "core/encoding/encoding.h"

namespace skyquilt::encoding {

class HashGrid : public Encoding {
 public:
  // Throws std::invalid_argument with the member that is out of range.
  explicit HashGrid(const HashGridConfig& config);

  int levels() const { return parts(); }
  const kernel::GridLevel& level(int l) const { return levels_[static_cast<size_t>(l)]; }
  int features() const { return features_; }
  // Sets reached[Offset(l) / features + e] = 1 for every entry e of every level l that Forward may read for positions in the box [low, high].
  void MarkUsed(const float low[3], const float high[3], std::span<uint8_t> reached) const;

  Kind kind() const override { return Kind::kHash; }
  void Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const override;
  void Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                float* table_gradient, uint8_t* touched) const override;
  const kernel::GridLevel* InterpolatesIn(int part) const override { return &level(part); }

 private:
  int features_;
  std::vector<kernel::GridLevel> levels_;
};

}  // namespace skyquilt::encoding
