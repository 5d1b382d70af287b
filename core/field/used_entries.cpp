#include "core/field/used_entries.h"

namespace skyquilt::field {
namespace {

// Cells are found in double and positions are rounded to float: a sample may be this far outside its cell, in unit lengths.
constexpr float kRounding = 1e-6F;

}  // namespace

std::vector<uint8_t> UsedEntries(const encoding::HashGrid& grid, const OccupancyGrid& occupancy) {
  std::vector<uint8_t> reached(static_cast<size_t>(grid.ParameterCount() / grid.features()), 0);
  int64_t index = 0;
  for (int z = 0; z < occupancy.size[2]; ++z) {
    for (int y = 0; y < occupancy.size[1]; ++y) {
      // Neighbours in a row have most corners in common: use one box for all of them.
      for (int x = 0; x < occupancy.size[0]; ++index) {
        const int begin = x++;
        if (!occupancy.occupied[static_cast<size_t>(index)]) continue;
        for (; x < occupancy.size[0] && occupancy.occupied[static_cast<size_t>(index + 1)]; ++x) ++index;
        const int low[3] = {begin, y, z}, high[3] = {x, y + 1, z + 1};
        float box_low[3], box_high[3];
        for (int axis = 0; axis < 3; ++axis) {
          box_low[axis] = static_cast<float>(low[axis]) * occupancy.cell - kRounding;
          box_high[axis] = static_cast<float>(high[axis]) * occupancy.cell + kRounding;
        }
        grid.MarkUsed(box_low, box_high, reached);
      }
    }
  }
  std::vector<uint8_t> bits((reached.size() + 7) / 8, 0);
  for (size_t i = 0; i < reached.size(); ++i) bits[i / 8] = static_cast<uint8_t>(bits[i / 8] | static_cast<unsigned>(reached[i]) << i % 8);
  return bits;
}

}  // namespace skyquilt::field
