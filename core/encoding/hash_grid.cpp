#include "core/encoding/hash_grid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace skyquilt::encoding {
namespace {

void Require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument("hash grid: " + what);
}

}  // namespace

HashGrid::HashGrid(const HashGridConfig& config) : config_(config) {
  Require(config.levels >= 1 && config.levels <= 16, "levels must be 1..16, got " + std::to_string(config.levels));
  Require(config.features == 2 || config.features == 4, "features must be 2 or 4, got " + std::to_string(config.features));
  Require(config.log2_table_size >= 1 && config.log2_table_size <= 24,
          "log2_table_size must be 1..24, got " + std::to_string(config.log2_table_size));
  Require(config.base_resolution >= 1.0 && std::isfinite(config.base_resolution), "base_resolution must be at least 1");
  Require(config.finest_resolution >= config.base_resolution && config.finest_resolution <= 1e6,
          "finest_resolution must lie in base_resolution..1e6");
  for (const double edge : config.extent) Require(edge > 0.0 && edge <= 1.0, "extent must lie in (0, 1]");

  const double growth =
      config.levels > 1 ? std::exp(std::log(config.finest_resolution / config.base_resolution) / static_cast<double>(config.levels - 1)) : 1.0;
  const auto table = static_cast<uint32_t>(1U << static_cast<uint32_t>(config.log2_table_size));
  offsets_.push_back(0);
  for (int l = 0; l < config.levels; ++l) {
    const double resolution = config.base_resolution * std::pow(growth, l);
    kernel::HashLevel level;
    level.cells_per_unit = static_cast<float>(resolution);
    double points = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
      level.size[axis] = std::max(2, static_cast<int32_t>(std::ceil(config.extent[axis] * resolution - 1e-9)) + 1);
      points *= level.size[axis];
    }
    level.dense = points <= static_cast<double>(table);
    level.entries = level.dense ? static_cast<uint32_t>(points) : table;
    levels_.push_back(level);
    // Whole cache lines per level, so that optimiser and gradients work line by line.
    const int64_t floats = static_cast<int64_t>(level.entries) * config.features;
    offsets_.push_back(offsets_.back() + (floats + kernel::kLineFloats - 1) / kernel::kLineFloats * kernel::kLineFloats);
  }
}

}  // namespace skyquilt::encoding
