// Geometry of a multi-resolution hash grid over a box with edges `extent` (longest 1): levels between a base and a finest resolution
// grow geometrically; a level whose lattice fits its table is dense (Mueller et al. 2022, eq. 2-4).
#pragma once

#include <cstdint>
#include <vector>

#include "core/kernel/kernels.h"

namespace skyquilt::encoding {

struct HashGridConfig {
  int levels = 8;                      // 1..16
  int features = 4;                    // per entry: 2 or 4
  int log2_table_size = 17;            // 1..24; entries per hashed level
  double base_resolution = 16;         // cells per unit length of the coarsest level, >= 1
  double finest_resolution = 512;      // of the finest, >= base
  double extent[3] = {1.0, 1.0, 1.0};  // box edges in (0, 1], the longest is 1
};

class HashGrid {
 public:
  // Throws std::invalid_argument naming the field that is out of range.
  explicit HashGrid(const HashGridConfig& config);

  const HashGridConfig& config() const { return config_; }
  int levels() const { return config_.levels; }
  int features() const { return config_.features; }
  int OutputRows() const { return config_.levels * config_.features; }
  const kernel::HashLevel& level(int l) const { return levels_[static_cast<size_t>(l)]; }
  // Start of a level in the flat parameter buffer, in floats: a multiple of kernel::kLineFloats, the gap before it is never used.
  int64_t Offset(int l) const { return offsets_[static_cast<size_t>(l)]; }
  int64_t ParameterCount() const { return offsets_.back(); }

 private:
  HashGridConfig config_;
  std::vector<kernel::HashLevel> levels_;
  std::vector<int64_t> offsets_;  // levels + 1
};

}  // namespace skyquilt::encoding
