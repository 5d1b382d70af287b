#include "surface/maps/low_outliers.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "surface/maps/cell_plane.h"
#include "surface/maps/height_raster.h"
#include "surface/maps/window_filter.h"

namespace skyquilt::surface {
namespace {

constexpr double kLargestSide_m = 5.0;
constexpr double kLeastDepth_m = 1.0;
constexpr double kNoiseFactor = 3.0;
constexpr double kLeastRing = 0.75;  // share of the ring that must have heights
constexpr double kSmoothRing = 0.9;  // share of these that must lie near a plane
constexpr int kRing = 2;             // width of the ring in cells
constexpr size_t kNoiseSamples = 200000;

using Cell = std::pair<int, int>;  // column, row

class PitFinder {
 public:
  PitFinder(const base::Grid<float>& grid, double cell_m, double smooth_m)
      : grid_(grid),
        noise_m_(NoiseOf(grid)),
        smooth_m_(std::max(smooth_m, kNoiseFactor * noise_m_)),
        depth_m_(std::max(kLeastDepth_m, kNoiseFactor * noise_m_)),
        most_cells_(static_cast<size_t>(kLargestSide_m * kLargestSide_m / (cell_m * cell_m))),
        visited_(grid.value.size(), 0) {
    const base::Grid<float> closed = Closing(grid, std::max(1, static_cast<int>(std::lround(0.5 * kLargestSide_m / cell_m))));
    low_.resize(grid.value.size());
    for (size_t i = 0; i < low_.size(); ++i) low_[i] = static_cast<double>(closed.value[i] - grid.value[i]) > smooth_m_ ? 1 : 0;
  }

  // The cells of all pits.
  std::vector<Cell> Find() {
    std::vector<Cell> pits;
    for (int row = 0; row < grid_.rows; ++row) {
      base::ThrowIfCancelled();
      for (int column = 0; column < grid_.columns; ++column) {
        if (low_[grid_.Index(column, row)] == 0 || visited_[grid_.Index(column, row)] != 0) continue;
        const std::vector<Cell> area = LowArea({column, row});
        if (area.size() <= most_cells_ && IsPit(area)) pits.insert(pits.end(), area.begin(), area.end());
      }
    }
    return pits;
  }

 private:
  std::vector<Cell> LowArea(const Cell& start) {
    std::vector<Cell> area = {start};
    visited_[grid_.Index(start.first, start.second)] = 1;
    for (size_t i = 0; i < area.size(); ++i) {
      const auto [column, row] = area[i];
      for (int r = std::max(0, row - 1); r <= std::min(grid_.rows - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(grid_.columns - 1, column + 1); ++c) {
          const size_t index = grid_.Index(c, r);
          if (low_[index] == 0 || visited_[index] != 0) continue;
          visited_[index] = 1;
          area.emplace_back(c, r);
        }
      }
    }
    return area;
  }

  bool IsPit(const std::vector<Cell>& area) const {
    const std::vector<Cell> ring = RingAround(area);
    PlaneFit fit(area.front().first, area.front().second);
    size_t n = 0;
    for (const auto& [column, row] : ring) {
      if (!Inside(column, row) || std::isnan(grid_.At(column, row))) continue;
      fit.Add(column, row, static_cast<double>(grid_.At(column, row)));
      ++n;
    }
    if (n < 6 || static_cast<double>(n) < kLeastRing * static_cast<double>(ring.size())) return false;
    const Plane plane = fit.Fit();
    std::vector<double> distances;
    for (const auto& [column, row] : ring) {
      if (!Inside(column, row) || std::isnan(grid_.At(column, row))) continue;
      distances.push_back(std::abs(static_cast<double>(grid_.At(column, row)) - plane.At(column, row)));
    }
    if (base::NearestRankQuantile(distances, kSmoothRing) > smooth_m_) return false;
    return std::any_of(area.begin(), area.end(), [&](const Cell& cell) {
      return plane.At(cell.first, cell.second) - static_cast<double>(grid_.At(cell.first, cell.second)) > depth_m_;
    });
  }

  // The cells near the area but not in it, in order; also those outside the grid.
  static std::vector<Cell> RingAround(const std::vector<Cell>& area) {
    std::vector<Cell> inner = area;
    std::sort(inner.begin(), inner.end());
    std::vector<Cell> near;
    for (const auto& [column, row] : area) {
      for (int r = row - kRing; r <= row + kRing; ++r) {
        for (int c = column - kRing; c <= column + kRing; ++c) near.emplace_back(c, r);
      }
    }
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    std::vector<Cell> ring;
    std::set_difference(near.begin(), near.end(), inner.begin(), inner.end(), std::back_inserter(ring));
    return ring;
  }

  bool Inside(int column, int row) const { return column >= 0 && row >= 0 && column < grid_.columns && row < grid_.rows; }

  const base::Grid<float>& grid_;
  double noise_m_, smooth_m_, depth_m_;
  size_t most_cells_;
  std::vector<uint8_t> low_, visited_;
};

}  // namespace

double NoiseOf(const base::Grid<float>& grid) {
  // The second difference of three cells in a row: slopes cancel, independent noise is enlarged by the square root of 1 + 4 + 1.
  std::vector<float> differences;
  const size_t step = std::max<size_t>(1, grid.value.size() / kNoiseSamples);
  for (size_t i = 1; i + 1 < grid.value.size(); i += step) {
    const auto column = static_cast<int>(i % static_cast<size_t>(grid.columns));
    if (column == 0 || column == grid.columns - 1) continue;
    const float difference = std::abs(grid.value[i - 1] - 2.0F * grid.value[i] + grid.value[i + 1]);
    if (!std::isnan(difference)) differences.push_back(difference);
  }
  if (differences.empty()) return 0.0;
  return base::kMadToSigma * static_cast<double>(base::UpperMedian(differences)) / std::sqrt(6.0);
}

int64_t RemoveLowOutliers(base::Grid<float>* grid, double cell_m, double smooth_m) {
  const std::vector<Cell> pits = PitFinder(*grid, cell_m, smooth_m).Find();
  for (const auto& [column, row] : pits) grid->value[grid->Index(column, row)] = kNoHeight;
  return static_cast<int64_t>(pits.size());
}

}  // namespace skyquilt::surface
