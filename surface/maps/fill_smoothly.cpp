#include "surface/maps/fill_smoothly.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/cancel.h"
#include "surface/maps/cell_plane.h"
#include "surface/maps/height_raster.h"

namespace skyquilt::surface {
namespace {

constexpr int kSweeps = 40;
constexpr float kOverRelaxation = 1.6F;

// Linear interpolation between two cells of a line of `count` cells.
struct Between {
  int first = 0, second = 0;
  float share = 0.0F;
};
Between Neighbours(float position, int count) {
  const float clamped = std::clamp(position, 0.0F, static_cast<float>(count - 1));
  const int first = std::min(static_cast<int>(clamped), count - 1);
  return {first, std::min(first + 1, count - 1), clamped - static_cast<float>(first)};
}

// Means of 2 x 2 cells over those with a value.
base::Grid<float> Halved(const base::Grid<float>& fine) {
  base::Grid<float> coarse((fine.columns + 1) / 2, (fine.rows + 1) / 2, kNoHeight);
  for (int row = 0; row < coarse.rows; ++row) {
    for (int column = 0; column < coarse.columns; ++column) {
      float sum = 0.0F, n = 0.0F;
      for (int r = 2 * row; r < std::min(2 * row + 2, fine.rows); ++r) {
        for (int c = 2 * column; c < std::min(2 * column + 2, fine.columns); ++c) {
          const float value = fine.At(c, r);
          if (std::isnan(value)) continue;
          sum += value;
          n += 1.0F;
        }
      }
      if (n > 0.0F) coarse.value[coarse.Index(column, row)] = sum / n;
    }
  }
  return coarse;
}

// Moves every cell of a gap towards the mean of its neighbours, in alternating order so that no direction is preferred.
void Relax(const std::vector<uint8_t>& known, base::Grid<float>* grid) {
  const int last_column = grid->columns - 1, last_row = grid->rows - 1;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    base::ThrowIfCancelled();
    float largest = 0.0F;
    for (int i = 0; i < grid->rows; ++i) {
      const int row = sweep % 2 == 0 ? i : last_row - i;
      for (int j = 0; j < grid->columns; ++j) {
        const int column = sweep % 2 == 0 ? j : last_column - j;
        const size_t cell = grid->Index(column, row);
        if (known[cell] != 0) continue;
        float sum = 0.0F, n = 0.0F;
        const auto add = [&](int c, int r) {
          sum += grid->At(c, r);
          n += 1.0F;
        };
        if (column > 0) add(column - 1, row);
        if (column < last_column) add(column + 1, row);
        if (row > 0) add(column, row - 1);
        if (row < last_row) add(column, row + 1);
        if (n == 0.0F) continue;
        const float change = sum / n - grid->value[cell];
        grid->value[cell] += kOverRelaxation * change;
        largest = std::max(largest, std::abs(change));
      }
    }
    if (largest < 1e-4F) break;
  }
}

void Solve(base::Grid<float>* grid) {
  std::vector<uint8_t> known(grid->value.size());
  std::transform(grid->value.begin(), grid->value.end(), known.begin(), [](float value) { return std::isnan(value) ? uint8_t{0} : uint8_t{1}; });
  if (std::find(known.begin(), known.end(), uint8_t{0}) == known.end()) return;
  base::Grid<float> coarse = Halved(*grid);
  // A grid of one cell is known by now, as its cell is the mean of all.
  Solve(&coarse);
  for (int row = 0; row < grid->rows; ++row) {
    const Between v = Neighbours(0.5F * static_cast<float>(row) - 0.25F, coarse.rows);
    for (int column = 0; column < grid->columns; ++column) {
      const size_t cell = grid->Index(column, row);
      if (known[cell] != 0) continue;
      const Between u = Neighbours(0.5F * static_cast<float>(column) - 0.25F, coarse.columns);
      const float upper = (1.0F - u.share) * coarse.At(u.first, v.first) + u.share * coarse.At(u.second, v.first);
      const float lower = (1.0F - u.share) * coarse.At(u.first, v.second) + u.share * coarse.At(u.second, v.second);
      grid->value[cell] = (1.0F - v.share) * upper + v.share * lower;
    }
  }
  Relax(known, grid);
}

}  // namespace

void FillSmoothly(base::Grid<float>* grid) {
  PlaneFit fit(0.5 * grid->columns, 0.5 * grid->rows);
  bool any = false;
  for (int row = 0; row < grid->rows; ++row) {
    for (int column = 0; column < grid->columns; ++column) {
      const float value = grid->At(column, row);
      if (std::isnan(value)) continue;
      fit.Add(column, row, static_cast<double>(value));
      any = true;
    }
  }
  if (!any) return;
  const Plane plane = fit.Fit();
  base::Grid<float> rest = *grid;
  for (int row = 0; row < rest.rows; ++row) {
    for (int column = 0; column < rest.columns; ++column) rest.value[rest.Index(column, row)] -= static_cast<float>(plane.At(column, row));
  }
  Solve(&rest);
  for (int row = 0; row < rest.rows; ++row) {
    for (int column = 0; column < rest.columns; ++column) {
      float& value = grid->value[rest.Index(column, row)];
      if (std::isnan(value)) value = rest.At(column, row) + static_cast<float>(plane.At(column, row));
    }
  }
}

}  // namespace skyquilt::surface
