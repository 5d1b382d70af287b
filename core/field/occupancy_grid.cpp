#include "core/field/occupancy_grid.h"

#include <cmath>

namespace skyquilt::field {

OccupancyGrid OccupancyGrid::Make(const double extent[3], double wanted_cell, int64_t max_cells) {
  OccupancyGrid grid;
  double cell = wanted_cell;
  const auto cells_along = [&](int axis) { return std::max<int64_t>(1, static_cast<int64_t>(std::ceil(extent[axis] / cell - 1e-9))); };
  while (cells_along(0) * cells_along(1) * cells_along(2) > max_cells) cell *= 1.1;
  for (int axis = 0; axis < 3; ++axis) grid.size[axis] = static_cast<int>(cells_along(axis));
  grid.cell = static_cast<float>(cell);
  grid.tau.assign(static_cast<size_t>(grid.CellCount()), 0.0F);
  grid.occupied.assign(static_cast<size_t>(grid.CellCount()), true);
  grid.judged.assign(static_cast<size_t>(grid.CellCount()), 0);
  return grid;
}

int64_t OccupancyGrid::IndexAt(float x, float y, float z) const {
  const auto along = [&](float position, int axis) { return std::clamp(static_cast<int>(position / cell), 0, size[axis] - 1); };
  return Index(along(x, 0), along(y, 1), along(z, 2));
}

void OccupancyGrid::RaiseNeighbours(float solid, float wake) {
  const int64_t strides[3] = {1, size[0], static_cast<int64_t>(size[0]) * size[1]};
  // Raised cells stay below `solid`, so this can be done in place.
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      for (int x = 0; x < size[0]; ++x) {
        const int64_t index = Index(x, y, z);
        if (!(tau[static_cast<size_t>(index)] > solid)) continue;
        const int at[3] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          for (const int side : {-1, 1}) {
            if (at[axis] + side < 0 || at[axis] + side >= size[axis]) continue;
            float& neighbour = tau[static_cast<size_t>(index + side * strides[axis])];
            if (neighbour >= 0.0F) neighbour = std::max(neighbour, wake);
          }
        }
      }
    }
  }
}

void OccupancyGrid::UpdateOccupied(float limit) {
  double sum = 0.0;
  int64_t seen = 0;
  for (const float value : tau) {
    if (value >= 0.0F) {
      sum += static_cast<double>(value);
      ++seen;
    }
  }
  const float threshold = std::min(limit, seen > 0 ? static_cast<float>(sum / static_cast<double>(seen)) : 0.0F);
  // Few cells change, and a write to a bit waits for the one before.
  for (size_t i = 0; i < tau.size(); ++i) {
    const bool now = tau[i] > threshold;
    if (occupied[i] != now) occupied[i] = now;
  }
}

void OccupancyGrid::MarkUnsampled(float start) {
  for (size_t i = 0; i < tau.size(); ++i) {
    if (tau[i] != start) continue;
    tau[i] = -1.0F;
    occupied[i] = false;
  }
}

double OccupancyGrid::OccupiedShare() const {
  if (occupied.empty()) return 0.0;
  return static_cast<double>(std::count(occupied.begin(), occupied.end(), true)) / static_cast<double>(occupied.size());
}

void OccupancyGrid::Dilate(int cells) {
  // Dilation by a box is separable: one pass per axis.
  std::vector<bool> source = occupied;
  const int64_t strides[3] = {1, size[0], static_cast<int64_t>(size[0]) * size[1]};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<bool> result(source.size(), false);
    for (int z = 0; z < size[2]; ++z) {
      for (int y = 0; y < size[1]; ++y) {
        for (int x = 0; x < size[0]; ++x) {
          const int64_t index = Index(x, y, z);
          if (!source[static_cast<size_t>(index)]) continue;
          const int along = axis == 0 ? x : axis == 1 ? y : z;
          const int low = std::max(-cells, -along);
          const int high = std::min(cells, size[axis] - 1 - along);
          for (int k = low; k <= high; ++k) result[static_cast<size_t>(index + k * strides[axis])] = true;
        }
      }
    }
    source = std::move(result);
  }
  for (size_t i = 0; i < source.size(); ++i) occupied[i] = source[i] && tau[i] >= 0.0F;
}

}  // namespace skyquilt::field
