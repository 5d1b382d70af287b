#include "products/photo_map/height_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

constexpr int kBlockCells = 16;            // along a side
constexpr double kStartCells = 1.5;        // horizontal way from a place that is not looked at
constexpr double kCentreCells = 0.75;      // more than a line's way inside a cell can be from its point nearest to the cell's centre
constexpr double kSurfaceStepCells = 6.0;  // between neighbouring cells of one surface, which may be a steep roof
constexpr double kSlackCells = 1.5;        // of any surface
constexpr double kSlackPerRoughness = 3.0;
constexpr int kRoughStride = 4;  // cells between those of the 3 x 3 that a side's roughness is measured by

// Root mean square distance of 3 x 3 heights from their plane; the given cell is in the corner of those cells. Zero beside the border of the grid or
// of the surface, where they are not all known.
double RoughnessOfSide(const HeightGrid& surface, int column, int row, int stride_x, int stride_y) {
  const int last_column = column + 2 * stride_x, last_row = row + 2 * stride_y;
  if (last_column < 0 || last_row < 0 || last_column >= surface.grid().width || last_row >= surface.grid().height) return 0.0;
  std::array<double, 9> heights{};
  double mean = 0.0, slope_x = 0.0, slope_y = 0.0;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      const auto height = static_cast<double>(surface.HeightOf(column + x * stride_x, row + y * stride_y));
      heights[3 * static_cast<size_t>(y) + static_cast<size_t>(x)] = height;
      mean += height / 9.0;
      slope_x += (x - 1) * height / 6.0;
      slope_y += (y - 1) * height / 6.0;
    }
  }
  double squares = 0.0;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      const double off = heights[3 * static_cast<size_t>(y) + static_cast<size_t>(x)] - mean - (x - 1) * slope_x - (y - 1) * slope_y;
      squares += off * off;
    }
  }
  return std::isfinite(squares) ? std::sqrt(squares / 6.0) : 0.0;  // 9 heights, 3 of them for the plane
}

}  // namespace

// From a place to an eye; lengths of the horizontal way from the place in cells, x to the east and y to the south from the grid's corner.
struct HeightGrid::Line {
  double x, y;    // of the place
  double ux, uy;  // horizontal direction, of length 1
  double base_m;  // height at the place, slack included
  double rise_m;  // per cell of way
};

HeightGrid::HeightGrid(const gis::MapGrid& grid, std::vector<float> heights_m) : grid_(grid), heights_(std::move(heights_m)) {
  SKYQUILT_CHECK(heights_.size() == grid_.size(), "a height grid needs one height per cell");
  block_columns_ = (grid_.width + kBlockCells - 1) / kBlockCells;
  block_rows_ = (grid_.height + kBlockCells - 1) / kBlockCells;
  block_highest_.assign(static_cast<size_t>(block_columns_) * static_cast<size_t>(block_rows_), highest_);
  for (int row = 0; row < grid_.height; ++row) {
    float* const blocks = block_highest_.data() + static_cast<size_t>(row / kBlockCells) * static_cast<size_t>(block_columns_);
    for (int column = 0; column < grid_.width; ++column) {
      float& highest = blocks[column / kBlockCells];
      const float height = HeightOf(column, row);
      if (height > highest) highest = height;  // never for NaN
    }
  }
  for (const float highest : block_highest_) highest_ = std::max(highest_, highest);
}

double HeightGrid::HeightAt(const Eigen::Vector2d& easting_northing) const {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d cell = grid_.CellOf(easting_northing);
  // Cell -0.5 is the outer edge.
  if (!(cell.x() >= -1.0 && cell.y() >= -1.0 && cell.x() <= grid_.width && cell.y() <= grid_.height) || heights_.empty()) return none;
  const double x = std::clamp(cell.x(), 0.0, grid_.width - 1.0);
  const double y = std::clamp(cell.y(), 0.0, grid_.height - 1.0);
  const int column = static_cast<int>(x);
  const int row = static_cast<int>(y);
  const int next_column = std::min(column + 1, grid_.width - 1);
  const int next_row = std::min(row + 1, grid_.height - 1);
  const double a = static_cast<double>(HeightOf(column, row));
  const double b = static_cast<double>(HeightOf(next_column, row));
  const double c = static_cast<double>(HeightOf(column, next_row));
  const double d = static_cast<double>(HeightOf(next_column, next_row));
  const double u = x - column;
  const double v = y - row;
  const bool complete = !std::isnan(a + b + c + d);
  if (complete && std::max({a, b, c, d}) - std::min({a, b, c, d}) <= kSurfaceStepCells * grid_.resolution_m) {
    return (1.0 - v) * ((1.0 - u) * a + u * b) + v * ((1.0 - u) * c + u * d);
  }
  return v < 0.5 ? (u < 0.5 ? a : b) : (u < 0.5 ? c : d);
}

// Walks through the cells of a block that the line crosses on its way from `way` to `end` (Amanatides and Woo 1987).
bool HeightGrid::IsHiddenInBlock(const Line& line, int block_column, int block_row, double way, double end) const {
  const int first_column = block_column * kBlockCells;
  const int first_row = block_row * kBlockCells;
  const int last_column = std::min(first_column + kBlockCells, grid_.width) - 1;
  const int last_row = std::min(first_row + kBlockCells, grid_.height) - 1;
  int column = std::clamp(static_cast<int>(line.x + way * line.ux), first_column, last_column);
  int row = std::clamp(static_cast<int>(line.y + way * line.uy), first_row, last_row);
  const double infinity = std::numeric_limits<double>::infinity();
  const int step_x = line.ux > 0.0 ? 1 : -1;
  const int step_y = line.uy > 0.0 ? 1 : -1;
  double next_x = line.ux != 0.0 ? (column + (step_x > 0 ? 1 : 0) - line.x) / line.ux : infinity;
  double next_y = line.uy != 0.0 ? (row + (step_y > 0 ? 1 : 0) - line.y) / line.uy : infinity;
  const double across_x = std::abs(line.ux);  // way nearer to the next centre
  const double across_y = std::abs(line.uy);
  const double cell_x = across_x > 0.0 ? 1.0 / across_x : infinity;  // way through a column
  const double cell_y = across_y > 0.0 ? 1.0 / across_y : infinity;
  double centre = (column + 0.5 - line.x) * line.ux + (row + 0.5 - line.y) * line.uy;
  while (true) {
    if (static_cast<double>(HeightOf(column, row)) > line.base_m + line.rise_m * centre) return true;  // never for NaN
    if (std::min(next_x, next_y) >= end) return false;
    if (next_x < next_y) {
      column += step_x;
      next_x += cell_x;
      centre += across_x;
      if (column < first_column || column > last_column) return false;
    } else {
      row += step_y;
      next_y += cell_y;
      centre += across_y;
      if (row < first_row || row > last_row) return false;
    }
  }
}

bool HeightGrid::IsVisible(const Eigen::Vector3d& place, const Eigen::Vector3d& eye, double slack_m) const {
  if (!place.allFinite() || !eye.allFinite()) return false;
  const double dx = (eye.x() - place.x()) / grid_.resolution_m;
  const double dy = (place.y() - eye.y()) / grid_.resolution_m;
  const double length = std::sqrt(dx * dx + dy * dy);
  if (length <= kStartCells) return true;
  Line line;
  line.x = (place.x() - grid_.left) / grid_.resolution_m;
  line.y = (grid_.top - place.y()) / grid_.resolution_m;
  line.ux = dx / length;
  line.uy = dy / length;
  line.base_m = place.z() + slack_m;
  line.rise_m = (eye.z() - place.z()) / length;

  // The part of the way that is over the grid, and not above its highest cell.
  double way = kStartCells;
  double end = length;
  const double above_m = static_cast<double>(highest_) - line.base_m;
  if (line.rise_m > 0.0) {
    end = std::min(end, above_m / line.rise_m + kCentreCells);
  } else if (line.rise_m * (length + kCentreCells) >= above_m) {
    return true;
  }
  const auto clip = [&](double start, double direction, int cells) {
    if (direction == 0.0) {
      if (!(start >= 0.0 && start < cells)) end = 0.0;
      return;
    }
    const double at_first = -start / direction;
    const double at_last = (cells - start) / direction;
    way = std::max(way, std::min(at_first, at_last));
    end = std::min(end, std::max(at_first, at_last));
  };
  clip(line.x, line.ux, grid_.width);
  clip(line.y, line.uy, grid_.height);
  if (!(way < end)) return true;

  int block_column = std::clamp(static_cast<int>((line.x + way * line.ux) / kBlockCells), 0, block_columns_ - 1);
  int block_row = std::clamp(static_cast<int>((line.y + way * line.uy) / kBlockCells), 0, block_rows_ - 1);
  const double infinity = std::numeric_limits<double>::infinity();
  const int step_x = line.ux > 0.0 ? 1 : -1;
  const int step_y = line.uy > 0.0 ? 1 : -1;
  double next_x = line.ux != 0.0 ? ((block_column + (step_x > 0 ? 1 : 0)) * kBlockCells - line.x) / line.ux : infinity;
  double next_y = line.uy != 0.0 ? ((block_row + (step_y > 0 ? 1 : 0)) * kBlockCells - line.y) / line.uy : infinity;
  const double block_x = line.ux != 0.0 ? kBlockCells / std::abs(line.ux) : infinity;  // way through a column of blocks
  const double block_y = line.uy != 0.0 ? kBlockCells / std::abs(line.uy) : infinity;
  while (true) {
    const double out = std::min({next_x, next_y, end});
    const double lowest_m = line.base_m + line.rise_m * (line.rise_m > 0.0 ? way - kCentreCells : out + kCentreCells);
    const size_t block = static_cast<size_t>(block_row) * static_cast<size_t>(block_columns_) + static_cast<size_t>(block_column);
    if (static_cast<double>(block_highest_[block]) > lowest_m && IsHiddenInBlock(line, block_column, block_row, way, out)) return false;
    if (out >= end) return true;
    way = out;
    if (next_x < next_y) {
      block_column += step_x;
      next_x += block_x;
      if (block_column < 0 || block_column >= block_columns_) return true;
    } else {
      block_row += step_y;
      next_y += block_y;
      if (block_row < 0 || block_row >= block_rows_) return true;
    }
  }
}

std::vector<float> SightSlack(const HeightGrid& surface, base::ThreadPool& threads) {
  const gis::MapGrid& grid = surface.grid();
  const double least_m = kSlackCells * grid.resolution_m;
  std::vector<float> slack_m(grid.size());
  threads.ParallelFor(grid.height, [&](int64_t task, int /*thread*/) {
    const int row = static_cast<int>(task);
    for (int column = 0; column < grid.width; ++column) {
      double plainest_m = std::numeric_limits<double>::infinity();
      for (const auto& [side_x, side_y] : {std::pair{-1, -1}, std::pair{1, -1}, std::pair{-1, 1}, std::pair{1, 1}})
        plainest_m = std::min(plainest_m, RoughnessOfSide(surface, column, row, side_x * kRoughStride, side_y * kRoughStride));
      slack_m[grid.Index(column, row)] = static_cast<float>(least_m + kSlackPerRoughness * plainest_m);
    }
  });
  return slack_m;
}

}  // namespace skyquilt::products
