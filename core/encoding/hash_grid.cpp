#include "core/encoding/hash_grid.h"

#include <algorithm>
#include <cmath>

#include "core/encoding/lattice.h"

namespace skyquilt::encoding {

double LevelResolution(const HashGridConfig& config, int level) {
  const double growth =
      config.levels > 1 ? std::exp(std::log(config.finest_resolution / config.base_resolution) / static_cast<double>(config.levels - 1)) : 1.0;
  return config.base_resolution * std::pow(growth, level);
}

HashGrid::HashGrid(const HashGridConfig& config) : features_(config.features) {
  config.Check();
  const auto table = static_cast<uint32_t>(1U << static_cast<uint32_t>(config.log2_table_size));
  for (int l = 0; l < config.levels; ++l) {
    kernel::GridLevel level = DenseLattice(config.extent, LevelResolution(config, l));
    const double points = LatticePoints(level);
    level.dense = points <= static_cast<double>(table);
    level.entries = level.dense ? static_cast<uint32_t>(points) : table;
    levels_.push_back(level);
    AddPart(features_, static_cast<int64_t>(level.entries) * features_);
  }
}

void HashGrid::MarkUsed(const float low[3], const float high[3], std::span<uint8_t> reached) const {
  for (int l = 0; l < levels(); ++l) {
    const kernel::GridLevel& lattice = level(l);
    uint32_t first[3], last[3];
    for (size_t axis = 0; axis < 3; ++axis) {
      // First and last cell, computed as in Forward; the last lattice point is one after the last cell.
      const float scale = lattice.cells_per_unit;
      const int32_t cells = lattice.size[axis] - 1;
      const auto cell = [&](float at) { return std::clamp(static_cast<int32_t>(std::floor(at * scale)), 0, cells - 1); };
      first[axis] = static_cast<uint32_t>(cell(low[axis]));
      last[axis] = static_cast<uint32_t>(cell(high[axis])) + 1;
    }
    const auto start = static_cast<size_t>(Offset(l) / features_);
    for (uint32_t z = first[2]; z <= last[2]; ++z) {
      for (uint32_t y = first[1]; y <= last[1]; ++y) {
        for (uint32_t x = first[0]; x <= last[0]; ++x) reached[start + kernel::HashIndex(lattice, x, y, z)] = 1;
      }
    }
  }
}

void HashGrid::Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const {
  kernel::HashForward(level(part), features_, table, at, n, out, out_stride);
}

void HashGrid::Backward(int part, const float* /*table*/, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                        float* table_gradient, uint8_t* touched) const {
  kernel::HashBackward(level(part), features_, at, n, out_gradient, out_stride, table_gradient, touched);
}

}  // namespace skyquilt::encoding
