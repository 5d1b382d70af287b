#include "evaluate/ortho/map_seams.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "evaluate/measured.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr int kStripCells = 4;  // on each side
constexpr int kFlatReach = 3;   // cells
constexpr float kFlatContrast = 25.0F / 255.0F;
constexpr int64_t kLeastSeamCells = 32;
constexpr int kFirstPhoto = 2;  // value of the first photo of a survey in ortho_sources.tif

class SeamCounter {
 public:
  SeamCounter(const SeamWindow& window, const HeightMap* heights) : window_(window), heights_(heights) {
    // Beside rounding of heights and a slope of one in ten.
    flat_height_m_ = 0.15 + 0.1 * 2.0 * kStripCells * window.grid.resolution_m;
  }

  // The border between the cell and its neighbour to the east (dx = 1) or south (dy = 1).
  void Look(int x, int y, int dx, int dy, SeamSums* sums) const {
    const int a = Source(x, y), b = Source(x + dx, y + dy);
    if (a == b || a < kFirstPhoto || b < kFirstPhoto) return;
    std::array<double, 3> step{};
    double low_m = std::numeric_limits<double>::infinity(), high_m = -low_m;
    for (int k = 1 - kStripCells; k <= kStripCells; ++k) {
      const int px = x + k * dx, py = y + k * dy;
      const bool first_side = k <= 0;
      if (Source(px, py) != (first_side ? a : b) || *window_.map.known.At(px, py) == 0) return;
      if (heights_ != nullptr) {
        const double height_m = heights_->At(window_.grid.CellCentre(px, py));
        low_m = std::min(low_m, height_m);
        high_m = std::max(high_m, height_m);
      }
      for (int c = 0; c < 3; ++c) {
        const double error = static_cast<double>(window_.map.rgb.At(px, py)[c]) - static_cast<double>(window_.truth.rgb.At(px, py)[c]);
        step[static_cast<size_t>(c)] += (first_side ? error : -error) / kStripCells;
      }
    }
    if (high_m - low_m > flat_height_m_ || !IsFlat(x, y, dx, dy)) return;
    SeamSum& sum = (*sums)[{std::min(a, b), std::max(a, b)}];
    for (size_t c = 0; c < 3; ++c) sum.step[c] += a < b ? step[c] : -step[c];
    ++sum.n;
  }

 private:
  int Source(int x, int y) const {
    const float value = *window_.sources.At(x, y);
    return std::isfinite(value) ? static_cast<int>(value) : 0;
  }
  // The truth within kFlatReach cells of both cells.
  bool IsFlat(int x, int y, int dx, int dy) const {
    float low = std::numeric_limits<float>::infinity(), high = -low;
    for (int py = y - kFlatReach; py <= y + dy + kFlatReach; ++py) {
      for (int px = x - kFlatReach; px <= x + dx + kFlatReach; ++px) {
        if (*window_.truth.known.At(px, py) == 0) return false;
        const float* const rgb = window_.truth.rgb.At(px, py);
        const float brightness = (rgb[0] + rgb[1] + rgb[2]) / 3.0F;
        low = std::min(low, brightness);
        high = std::max(high, brightness);
      }
    }
    return high - low <= kFlatContrast;
  }

  const SeamWindow& window_;
  const HeightMap* heights_;
  double flat_height_m_ = 0.0;
};

}  // namespace

void AddSeams(const SeamWindow& window, const HeightMap* heights, SeamSums* sums) {
  SKYQUILT_CHECK(window.border >= kSeamReach, "cells around the window");
  const SeamCounter counter(window, heights);
  for (int y = window.border; y < window.sources.height - window.border; ++y) {
    for (int x = window.border; x < window.sources.width - window.border; ++x) {
      counter.Look(x, y, 1, 0, sums);
      counter.Look(x, y, 0, 1, sums);
    }
  }
}

void AddSeams(const SeamSums& others, SeamSums* sums) {
  for (const auto& [pair, other] : others) {
    SeamSum& sum = (*sums)[pair];
    for (size_t c = 0; c < 3; ++c) sum.step[c] += other.step[c];
    sum.n += other.n;
  }
}

SeamLevels LevelsOf(const SeamSums& sums) {
  SeamLevels levels;
  double total = 0.0;
  for (const auto& [pair, sum] : sums) {
    if (sum.n < kLeastSeamCells) continue;
    double size = 0.0;
    for (const double step : sum.step) size += 255.0 * std::abs(step / static_cast<double>(sum.n)) / 3.0;
    ++levels.pairs;
    total += size;
    levels.worst = std::max(levels.worst, size);
  }
  levels.mean = levels.pairs > 0 ? total / static_cast<double>(levels.pairs) : kNotMeasured;
  if (levels.pairs == 0) levels.worst = kNotMeasured;
  return levels;
}

}  // namespace skyquilt::evaluate::ortho
