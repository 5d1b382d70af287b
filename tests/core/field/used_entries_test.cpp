#include "core/field/used_entries.h"

#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/kernel/reference.h"

namespace skyquilt::field {
namespace {

encoding::HashGrid Grid(int log2_table_size) {
  encoding::HashGridConfig config;
  config.levels = 5;
  config.log2_table_size = log2_table_size;
  config.base_resolution = 4;
  config.finest_resolution = 60;
  config.extent[1] = 0.8;
  config.extent[2] = 0.3;
  return encoding::HashGrid(config);
}

OccupancyGrid Occupancy(uint64_t seed, double share) {
  const double extent[3] = {1.0, 0.8, 0.3};
  OccupancyGrid occupancy = OccupancyGrid::Make(extent, 0.07, 100000);
  base::Random random(seed);
  for (auto&& cell : occupancy.occupied) cell = random.UniformDouble() < share;
  return occupancy;
}

bool IsSet(const std::vector<uint8_t>& bits, size_t i) {
  return (bits[i / 8] >> i % 8 & 1U) != 0;
}

size_t Count(const std::vector<uint8_t>& bits) {
  size_t count = 0;
  for (size_t i = 0; i < 8 * bits.size(); ++i) count += IsSet(bits, i) ? 1 : 0;
  return count;
}

// Corners of random positions inside occupied cells, faces included.
TEST(UsedEntries, ContainAllThatPositionsInOccupiedCellsRead) {
  for (const int log2_table_size : {6, 12, 20}) {
    const encoding::HashGrid grid = Grid(log2_table_size);
    const OccupancyGrid occupancy = Occupancy(7, 0.1);
    const std::vector<uint8_t> bits = UsedEntries(grid, occupancy);
    ASSERT_EQ(bits.size(), (static_cast<size_t>(grid.ParameterCount() / grid.features()) + 7) / 8);
    base::Random random(11);
    int missing = 0;
    for (int z = 0; z < occupancy.size[2]; ++z) {
      for (int y = 0; y < occupancy.size[1]; ++y) {
        for (int x = 0; x < occupancy.size[0]; ++x) {
          if (!occupancy.occupied[static_cast<size_t>(occupancy.Index(x, y, z))]) continue;
          for (int i = 0; i < 60; ++i) {
            float p[3];
            const int cell[3] = {x, y, z};
            for (int axis = 0; axis < 3; ++axis) {
              const float at = i < 8 ? static_cast<float>(i >> axis & 1) : random.Uniform();
              p[axis] = (static_cast<float>(cell[axis]) + at) * occupancy.cell;
            }
            for (int l = 0; l < grid.levels(); ++l) {
              for (const auto& corner : kernel::reference::Corners<float>(grid.level(l), p)) {
                missing += IsSet(bits, static_cast<size_t>(grid.Offset(l) / grid.features()) + corner.entry) ? 0 : 1;
              }
            }
          }
        }
      }
    }
    EXPECT_EQ(missing, 0) << log2_table_size;
  }
}

TEST(UsedEntries, OmitThoseFarFromOccupiedCells) {
  const encoding::HashGrid grid = Grid(20);
  OccupancyGrid occupancy = Occupancy(7, 0.0);
  EXPECT_EQ(Count(UsedEntries(grid, occupancy)), 0U);
  occupancy.occupied[static_cast<size_t>(occupancy.Index(3, 4, 2))] = true;
  const std::vector<uint8_t> bits = UsedEntries(grid, occupancy);
  size_t most = 0;
  for (int l = 0; l < grid.levels(); ++l) {
    // Number of cells per axis that the box may overlap, and one more corner than cells.
    const auto corners = static_cast<size_t>(occupancy.cell * grid.level(l).cells_per_unit) + 3;
    most += corners * corners * corners;
  }
  EXPECT_LE(Count(bits), most);
  EXPECT_GE(Count(bits), 8U * static_cast<size_t>(grid.levels()));
  occupancy.occupied.assign(occupancy.occupied.size(), true);
  size_t entries = 0;
  for (int l = 0; l < grid.levels(); ++l) entries += grid.level(l).entries;
  EXPECT_EQ(Count(UsedEntries(grid, occupancy)), entries);
}

}  // namespace
}  // namespace skyquilt::field
