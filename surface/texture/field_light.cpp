#include "surface/texture/field_light.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/cancel.h"
#include "core/survey/picture_colors.h"

namespace skyquilt::surface {
namespace {

constexpr int64_t kCellsPerTask = 1024;
constexpr int kReachCells = 5;
constexpr double kSpreadCells = 2.0;
constexpr float kLeastLight = 0.001F;  // added to both sides of a ratio: dark places have no light to compare
constexpr float kMostGain = 6.0F;

using Gain = std::array<float, 3>;

// Cells of one chart and one view, on their grid.
class CellGrid {
 public:
  CellGrid(const std::vector<PhotoCell>& all, std::vector<int32_t> cells) : cells_(std::move(cells)) {
    const PhotoCell& first = all[static_cast<size_t>(cells_[0])];
    min_ = max_ = {first.x, first.y};
    for (const int32_t c : cells_) {
      const Eigen::Vector2i at(all[static_cast<size_t>(c)].x, all[static_cast<size_t>(c)].y);
      min_ = min_.cwiseMin(at);
      max_ = max_.cwiseMax(at);
    }
    width_ = max_.x() - min_.x() + 1;
    grid_.assign(static_cast<size_t>(width_) * static_cast<size_t>(max_.y() - min_.y() + 1), -1);
    for (const int32_t c : cells_) grid_[IndexOf(all[static_cast<size_t>(c)].x, all[static_cast<size_t>(c)].y)] = c;
  }
  const std::vector<int32_t>& cells() const { return cells_; }
  // -1: none there.
  int32_t At(int x, int y) const { return x < min_.x() || y < min_.y() || x > max_.x() || y > max_.y() ? -1 : grid_[IndexOf(x, y)]; }

 private:
  size_t IndexOf(int x, int y) const { return static_cast<size_t>(y - min_.y()) * static_cast<size_t>(width_) + static_cast<size_t>(x - min_.x()); }

  std::vector<int32_t> cells_;
  Eigen::Vector2i min_, max_;
  int width_ = 0;
  std::vector<int32_t> grid_;
};

// The field's light over the photo's, around a cell; `gain` where the field is not known there.
Gain GainAround(const CellGrid& grid, const PhotoTexture& texture, const TexelColors& field, const PhotoCell& cell, Gain gain) {
  Gain of_photo{}, of_field{};
  float sum = 0.0F;
  for (int y = cell.y - kReachCells; y <= cell.y + kReachCells; ++y) {
    for (int x = cell.x - kReachCells; x <= cell.x + kReachCells; ++x) {
      const int32_t other = grid.At(x, y);
      if (other < 0 || field.known[static_cast<size_t>(other)] == 0) continue;
      const PhotoCell& c = texture.cells[static_cast<size_t>(other)];
      const double distance2 = (x - cell.x) * (x - cell.x) + (y - cell.y) * (y - cell.y);
      const float weight = static_cast<float>(c.texels) * static_cast<float>(std::exp(-0.5 * distance2 / (kSpreadCells * kSpreadCells)));
      sum += weight;
      for (size_t k = 0; k < 3; ++k) {
        of_photo[k] += weight * c.light[k];
        of_field[k] += weight * survey::QuickLight(field.rgb_srgb[static_cast<size_t>(other)][k]);
      }
    }
  }
  if (!(sum > 0.0F)) return gain;
  for (size_t k = 0; k < 3; ++k) {
    gain[k] = std::clamp((of_field[k] / sum + kLeastLight) / (of_photo[k] / sum + kLeastLight), 1.0F / kMostGain, kMostGain);
  }
  return gain;
}

// Between the centres of the cells around a place of the chart, in texels.
Gain GainAt(const CellGrid& grid, const std::vector<Gain>& gains, double x, double y) {
  const double u = x / kPhotoCellTexels - 0.5, v = y / kPhotoCellTexels - 0.5;
  const int x0 = static_cast<int>(std::floor(u)), y0 = static_cast<int>(std::floor(v));
  Gain mean{};
  float sum = 0.0F;
  for (int corner = 0; corner < 4; ++corner) {
    const int dx = corner & 1, dy = corner >> 1;
    const int32_t cell = grid.At(x0 + dx, y0 + dy);
    if (cell < 0) continue;
    const auto weight = static_cast<float>((dx == 1 ? u - x0 : 1.0 - (u - x0)) * (dy == 1 ? v - y0 : 1.0 - (v - y0)));
    sum += weight;
    for (size_t k = 0; k < 3; ++k) mean[k] += weight * gains[static_cast<size_t>(cell)][k];
  }
  for (float& value : mean) value /= sum;  // the texel's own cell is one of the four, and its weight is not 0
  return mean;
}

}  // namespace

void BringIntoFieldLight(const AtlasLayout& layout, const AtlasTexels& texels, const TexelColors& field, base::ThreadPool& threads,
                         PhotoTexture* texture) {
  if (texture->cells.empty()) return;
  std::vector<CellGrid> grids;
  std::vector<int32_t> grid_of(texture->cells.size());
  for (size_t begin = 0; begin < texture->cells.size();) {
    std::map<int32_t, std::vector<int32_t>> of_view;
    const uint32_t chart = texture->cells[begin].chart;
    for (; begin < texture->cells.size() && texture->cells[begin].chart == chart; ++begin) {
      of_view[texture->cells[begin].view].push_back(static_cast<int32_t>(begin));
    }
    for (auto& [view, cells] : of_view) {
      for (const int32_t c : cells) grid_of[static_cast<size_t>(c)] = static_cast<int32_t>(grids.size());
      grids.emplace_back(texture->cells, std::move(cells));
    }
  }
  int32_t last_view = 0;
  for (const PhotoCell& cell : texture->cells) last_view = std::max(last_view, cell.view);
  const std::vector<Gain> of_view = GainsOfViews(static_cast<size_t>(last_view) + 1, *texture, field);
  std::vector<Gain> gains(texture->cells.size());
  const auto n_cells = static_cast<int64_t>(gains.size());
  threads.ParallelFor((n_cells + kCellsPerTask - 1) / kCellsPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t c = task * kCellsPerTask; c < std::min(n_cells, (task + 1) * kCellsPerTask); ++c) {
      const auto i = static_cast<size_t>(c);
      gains[i] = GainAround(grids[static_cast<size_t>(grid_of[i])], *texture, field, texture->cells[i],
                            of_view[static_cast<size_t>(texture->cells[i].view)]);
    }
  });
  threads.ParallelFor(static_cast<int64_t>(layout.charts.size()), [&](int64_t task, int) {
    const auto chart = static_cast<size_t>(task);
    for (size_t i = texels.first[chart]; i < texels.first[chart + 1]; ++i) {
      if (texture->cell[i] < 0) continue;
      const Eigen::Vector2i at = Eigen::Vector2i(texels.texel[i].x, texels.texel[i].y) - layout.corner[chart];
      const CellGrid& grid = grids[static_cast<size_t>(grid_of[static_cast<size_t>(texture->cell[i])])];
      texture->rgb_srgb[i] = survey::InLight(texture->rgb_srgb[i], GainAt(grid, gains, at.x() + 0.5, at.y() + 0.5));
    }
  });
}

}  // namespace skyquilt::surface
