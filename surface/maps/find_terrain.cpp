#include "surface/maps/find_terrain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "surface/maps/fill_smoothly.h"
#include "surface/maps/low_outliers.h"
#include "surface/maps/window_filter.h"

namespace skyquilt::surface {
namespace {

constexpr double kLowQuantile = 0.1;
constexpr double kLargestGrowth_m = 3.0;   // of the window from one step to the next
constexpr double kLeastGroundShare = 0.1;  // of the heights in a working cell, so that their mean stands for the cell
constexpr std::array<float, 5> kSmoothing = {1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};

// Working cells are squares of `factor` x `factor` cells of the surface; those at the eastern and southern edge may be cut off.
struct WorkingCells {
  int factor = 1;
  int columns = 0, rows = 0;
  double cell_m = 0.0;
};

WorkingCells PlanWorkingCells(const gis::MapGrid& grid, double cell_m) {
  WorkingCells cells;
  cells.factor = std::max(1, static_cast<int>(std::lround(cell_m / grid.resolution_m)));
  cells.columns = (grid.width - 1) / cells.factor + 1;
  cells.rows = (grid.height - 1) / cells.factor + 1;
  cells.cell_m = cells.factor * grid.resolution_m;
  return cells;
}

base::Grid<float> LowHeights(const HeightRaster& surface, const WorkingCells& cells) {
  base::Grid<float> low(cells.columns, cells.rows, kNoHeight);
  std::vector<float> inside;
  for (int row = 0; row < cells.rows; ++row) {
    const int last_y = std::min((row + 1) * cells.factor, surface.grid.height);
    for (int column = 0; column < cells.columns; ++column) {
      const int last_x = std::min((column + 1) * cells.factor, surface.grid.width);
      inside.clear();
      for (int y = row * cells.factor; y < last_y; ++y) {
        for (int x = column * cells.factor; x < last_x; ++x) {
          const float height = surface.height_m[surface.grid.Index(x, y)];
          if (std::isfinite(height)) inside.push_back(height);
        }
      }
      if (!inside.empty()) low.value[low.Index(column, row)] = base::NearestRankQuantile(inside, kLowQuantile);
    }
  }
  return low;
}

// In working cells. Windows larger than the grid, which has at most `most` columns or rows, see no more than one of its size.
int HalfWindow(double window_m, double cell_m, int most) {
  return static_cast<int>(std::clamp(std::ceil(0.5 * window_m / cell_m), 1.0, static_cast<double>(std::max(1, most))));
}

// Half widths of the windows in working cells; a window has 2 * half + 1.
std::vector<int> WindowHalves(const TerrainOptions& options, double cell_m, int most) {
  const double allowed = options.slope > 0.0 ? (options.high_m - options.low_m) / options.slope : kLargestGrowth_m;
  const int largest_step = std::max(1, static_cast<int>(std::min(kLargestGrowth_m, allowed) / (2.0 * cell_m)));
  const int last = HalfWindow(options.window_m, cell_m, most);
  std::vector<int> halves;
  for (int half = 1; half < last; half += std::clamp(half / 4, 1, largest_step)) halves.push_back(half);
  halves.push_back(std::max(1, last));
  return halves;
}

// Removes the cells of what stands on the ground.
void KeepGround(const TerrainOptions& options, double cell_m, base::Grid<float>* low, base::Progress* progress) {
  base::Grid<float> opened = *low;
  int previous = 0;
  const std::vector<int> halves = WindowHalves(options, cell_m, std::max(low->columns, low->rows));
  for (size_t step = 0; step < halves.size(); ++step) {
    base::ThrowIfCancelled();
    const double growth_m = 2.0 * (halves[step] - previous) * cell_m;
    const auto threshold = static_cast<float>(std::min(options.high_m, options.low_m + options.slope * growth_m));
    const base::Grid<float> next = Opening(opened, halves[step]);
    for (size_t i = 0; i < next.value.size(); ++i) {
      if (opened.value[i] - next.value[i] > threshold) low->value[i] = kNoHeight;
    }
    opened = next;
    previous = halves[step];
    progress->Update(static_cast<double>(step + 1) / static_cast<double>(halves.size()));
  }
}

// Interpolates heights of working cells linearly at the cells of the surface; outside the outermost centres it goes on straight.
class Upsampled {
 public:
  Upsampled(const base::Grid<float>& coarse, const WorkingCells& cells, int width) : coarse_(coarse), factor_(cells.factor) {
    for (int x = 0; x < width; ++x) columns_.push_back(Around(x, coarse.columns));
  }
  void Row(int y, std::vector<float>* heights) const {
    const Pair v = Around(y, coarse_.rows);
    const float* upper = coarse_.value.data() + coarse_.Index(0, v.first);
    const float* lower = coarse_.value.data() + coarse_.Index(0, v.second);
    heights->resize(columns_.size());
    for (size_t x = 0; x < columns_.size(); ++x) {
      const Pair& u = columns_[x];
      const float left = upper[u.first] + v.share * (lower[u.first] - upper[u.first]);
      const float right = upper[u.second] + v.share * (lower[u.second] - upper[u.second]);
      (*heights)[x] = left + u.share * (right - left);
    }
  }

 private:
  struct Pair {
    int first = 0, second = 0;
    float share = 0.0F;
  };
  Pair Around(int cell, int count) const {
    if (count == 1) return {};
    const double position = (cell + 0.5) / factor_ - 0.5;
    const int first = std::clamp(static_cast<int>(std::floor(position)), 0, count - 2);
    return {first, first + 1, static_cast<float>(position - first)};
  }
  const base::Grid<float>& coarse_;
  int factor_;
  std::vector<Pair> columns_;
};

// Per working cell, how far the surface may be from the terrain to be ground: low_m and what the ground rises in a working cell.
base::Grid<float> Tolerance(const base::Grid<float>& terrain, double cell_m, const TerrainOptions& options) {
  base::Grid<float> tolerance(terrain.columns, terrain.rows);
  const double most = options.slope * cell_m;
  for (int row = 0; row < terrain.rows; ++row) {
    const int north = std::max(0, row - 1), south = std::min(terrain.rows - 1, row + 1);
    for (int column = 0; column < terrain.columns; ++column) {
      const int west = std::max(0, column - 1), east = std::min(terrain.columns - 1, column + 1);
      const double dx = static_cast<double>(terrain.At(east, row) - terrain.At(west, row)) / std::max(1, east - west);
      const double dy = static_cast<double>(terrain.At(column, south) - terrain.At(column, north)) / std::max(1, south - north);
      tolerance.value[tolerance.Index(column, row)] = static_cast<float>(options.low_m + std::min(most, std::hypot(dx, dy)));
    }
  }
  return tolerance;
}

// Per cell of the surface: 1 where it is ground.
std::vector<uint8_t> GroundMask(const HeightRaster& surface, const WorkingCells& cells, const base::Grid<float>& terrain,
                                const TerrainOptions& options) {
  std::vector<uint8_t> ground(surface.height_m.size(), 0);
  const Upsampled upsampled(terrain, cells, surface.grid.width);
  const base::Grid<float> tolerance = Tolerance(terrain, cells.cell_m, options);
  std::vector<float> heights;
  size_t cell = 0;
  for (int y = 0; y < surface.grid.height; ++y) {
    base::ThrowIfCancelled();
    upsampled.Row(y, &heights);
    for (int x = 0; x < surface.grid.width; ++x, ++cell) {
      const float allowed = tolerance.At(x / cells.factor, y / cells.factor);
      ground[cell] = std::abs(surface.height_m[cell] - heights[static_cast<size_t>(x)]) < allowed ? 1 : 0;
    }
  }
  return ground;
}

// Mean height of the ground in each working cell: unlike the low heights, not moved by noise.
base::Grid<float> GroundMeans(const HeightRaster& surface, const std::vector<uint8_t>& ground, const WorkingCells& cells) {
  base::Grid<float> means(cells.columns, cells.rows, kNoHeight);
  const auto n = static_cast<size_t>(cells.columns);
  std::vector<double> sum(n);
  std::vector<int> count(n), all(n);
  size_t cell = 0;
  for (int row = 0; row < cells.rows; ++row) {
    std::fill(sum.begin(), sum.end(), 0.0);
    std::fill(count.begin(), count.end(), 0);
    std::fill(all.begin(), all.end(), 0);
    for (int y = row * cells.factor; y < std::min((row + 1) * cells.factor, surface.grid.height); ++y) {
      for (int x = 0; x < surface.grid.width; ++x, ++cell) {
        const auto column = static_cast<size_t>(x / cells.factor);
        all[column] += std::isfinite(surface.height_m[cell]) ? 1 : 0;
        if (ground[cell] == 0) continue;
        sum[column] += static_cast<double>(surface.height_m[cell]);
        ++count[column];
      }
    }
    for (size_t column = 0; column < n; ++column) {
      if (count[column] > 0 && count[column] >= kLeastGroundShare * all[column]) {
        means.value[means.Index(static_cast<int>(column), row)] = static_cast<float>(sum[column] / count[column]);
      }
    }
  }
  return means;
}

// 1 for working cells inside the outline of the data, closed over gaps.
std::vector<uint8_t> ClosedOutline(const base::Grid<float>& data, double window_m, double cell_m) {
  const int half = HalfWindow(window_m, cell_m, std::max(data.columns, data.rows));
  // With a border as wide as the window reaches, so that the outline is not drawn to the grid's edge.
  base::Grid<float> padded(data.columns + 2 * half, data.rows + 2 * half, 0.0F);
  for (int row = 0; row < data.rows; ++row) {
    for (int column = 0; column < data.columns; ++column) {
      if (!std::isnan(data.At(column, row))) padded.value[padded.Index(column + half, row + half)] = 1.0F;
    }
  }
  padded = WindowMinimum(WindowMaximum(padded, half), half);
  std::vector<uint8_t> inside(data.value.size());
  for (int row = 0; row < data.rows; ++row) {
    for (int column = 0; column < data.columns; ++column) {
      inside[data.Index(column, row)] = padded.At(column + half, row + half) > 0.5F ? 1 : 0;
    }
  }
  return inside;
}

// Terrain of the working cells plus the smoothed detail of the surface where it is ground, which fades out at the edge of the ground.
void Compose(const HeightRaster& surface, const WorkingCells& cells, const base::Grid<float>& coarse, const std::vector<uint8_t>& outline,
             Terrain* terrain) {
  constexpr int kReach = static_cast<int>(kSmoothing.size()) / 2;
  const int width = surface.grid.width, height = surface.grid.height;
  const Upsampled upsampled(coarse, cells, width);
  std::array<std::vector<float>, kSmoothing.size()> smoothed_rows;  // detail smoothed along rows; row y is at y modulo their number
  std::vector<float> base_heights, detail;
  const auto smooth_row = [&](int y, std::vector<float>* row) {
    row->assign(static_cast<size_t>(width), 0.0F);
    if (y < 0 || y >= height) return;
    upsampled.Row(y, &base_heights);
    detail.assign(static_cast<size_t>(width) + 2 * kReach, 0.0F);
    for (int x = 0; x < width; ++x) {
      const auto i = static_cast<size_t>(x);
      if (terrain->is_ground[surface.grid.Index(x, y)] != 0) detail[i + kReach] = surface.height_m[surface.grid.Index(x, y)] - base_heights[i];
    }
    for (size_t x = 0; x < row->size(); ++x) {
      for (size_t k = 0; k < kSmoothing.size(); ++k) (*row)[x] += kSmoothing[k] * detail[x + k];
    }
  };
  const auto slot = [](int y) { return static_cast<size_t>((y + static_cast<int>(kSmoothing.size())) % static_cast<int>(kSmoothing.size())); };
  for (int y = -kReach; y < kReach; ++y) smooth_row(y, &smoothed_rows[slot(y)]);
  for (int y = 0; y < height; ++y) {
    base::ThrowIfCancelled();
    smooth_row(y + kReach, &smoothed_rows[slot(y + kReach)]);
    upsampled.Row(y, &base_heights);
    for (int x = 0; x < width; ++x) {
      if (outline[coarse.Index(x / cells.factor, y / cells.factor)] == 0) continue;
      float sum = base_heights[static_cast<size_t>(x)];
      for (int k = -kReach; k <= kReach; ++k) sum += kSmoothing[static_cast<size_t>(k + kReach)] * smoothed_rows[slot(y + k)][static_cast<size_t>(x)];
      terrain->height.height_m[surface.grid.Index(x, y)] = sum;
    }
  }
}

}  // namespace

Terrain FindTerrain(const HeightRaster& surface, const TerrainOptions& options) {
  const gis::MapGrid& grid = surface.grid;
  SKYQUILT_CHECK(surface.height_m.size() == grid.size(), std::to_string(surface.height_m.size()));
  SKYQUILT_CHECK(options.cell_m > 0.0 && options.window_m > 0.0 && options.slope >= 0.0, "options of the terrain");
  Terrain terrain;
  terrain.height = {grid, std::vector<float>(surface.height_m.size(), kNoHeight)};
  terrain.is_ground.assign(surface.height_m.size(), 0);
  if (surface.height_m.empty()) return terrain;
  base::Progress progress("ground", 1.0, "parts");
  const WorkingCells cells = PlanWorkingCells(grid, options.cell_m);
  base::Grid<float> low = LowHeights(surface, cells);
  if (std::all_of(low.value.begin(), low.value.end(), [](float value) { return std::isnan(value); })) return terrain;
  const std::vector<uint8_t> outline = ClosedOutline(low, options.window_m, cells.cell_m);
  const int64_t pits = RemoveLowOutliers(&low, cells.cell_m, options.low_m);
  if (pits > 0) base::LogDebug("{} working cells of the surface are pits below the ground and are left out", pits);
  KeepGround(options, cells.cell_m, &low, &progress);
  FillSmoothly(&low);
  base::Grid<float> means = GroundMeans(surface, GroundMask(surface, cells, low, options), cells);
  FillSmoothly(&means);
  // Without any ground near the first estimate, that one is the best there is.
  const base::Grid<float>& coarse = std::isnan(means.value.front()) ? low : means;
  terrain.is_ground = GroundMask(surface, cells, coarse, options);
  Compose(surface, cells, coarse, outline, &terrain);
  progress.Finish();
  return terrain;
}

}  // namespace skyquilt::surface
