#include "core/encoding/hash_grid.h"

#include <cmath>

#include "core/encoding/lattice.h"

namespace skyquilt::encoding {

HashGrid::HashGrid(const HashGridConfig& config) : features_(config.features) {
  config.Check();
  const double growth =
      config.levels > 1 ? std::exp(std::log(config.finest_resolution / config.base_resolution) / static_cast<double>(config.levels - 1)) : 1.0;
  const auto table = static_cast<uint32_t>(1U << static_cast<uint32_t>(config.log2_table_size));
  for (int l = 0; l < config.levels; ++l) {
    kernel::HashLevel level = DenseLattice(config.extent, config.base_resolution * std::pow(growth, l));
    const double points = LatticePoints(level);
    level.dense = points <= static_cast<double>(table);
    level.entries = level.dense ? static_cast<uint32_t>(points) : table;
    levels_.push_back(level);
    AddPart(features_, static_cast<int64_t>(level.entries) * features_);
  }
}

void HashGrid::Forward(int part, const float* table, const float* x, const float* y, const float* z, int64_t n, float* out, size_t out_stride) const {
  kernel::HashForward(level(part), features_, table, x, y, z, n, out, out_stride);
}

void HashGrid::Backward(int part, const float* /*table*/, const float* x, const float* y, const float* z, int64_t n, const float* out_gradient,
                        size_t out_stride, float* table_gradient, uint8_t* touched) const {
  kernel::HashBackward(level(part), features_, x, y, z, n, out_gradient, out_stride, table_gradient, touched);
}

}  // namespace skyquilt::encoding
