#include "evaluate/ortho/true_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/base/errors.h"
#include "core/image/srgb.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr float kOpaque = 127.5F;   // least alpha of a cell with data
constexpr double kNoWeight = 1e-6;  // cells that touch by rounding only

// What a cell of the result takes along one axis: cells of the source from `first` on.
struct Taps {
  int first = 0;
  std::vector<float> weight;
};

// n cells whose outer edges are at from + i * step, in cells of the source. Small ones are interpolated by cubics (Catmull-Rom), which keep more of
// the truth's sharpness than straight lines would.
std::vector<Taps> TapsOf(double from, double step, int n) {
  std::vector<Taps> taps(static_cast<size_t>(n));
  for (int i = 0; i < n; ++i) {
    Taps& one = taps[static_cast<size_t>(i)];
    const double low = from + i * step, high = low + step;
    if (step > 1.0 + kNoWeight) {
      one.first = static_cast<int>(std::floor(low + kNoWeight));
      for (int cell = one.first; cell < high - kNoWeight; ++cell) {
        one.weight.push_back(static_cast<float>((std::min(high, cell + 1.0) - std::max(low, static_cast<double>(cell))) / step));
      }
    } else {
      const double centre = 0.5 * (low + high) - 0.5;
      const double whole = std::floor(centre + kNoWeight), f = std::max(centre - whole, 0.0);
      one.first = static_cast<int>(whole);
      if (f <= kNoWeight) {
        one.weight.push_back(1.0F);
        continue;
      }
      --one.first;
      for (const double weight :
           {f * (f * (1.0 - 0.5 * f) - 0.5), 1.0 + f * f * (1.5 * f - 2.5), f * (f * (2.0 - 1.5 * f) + 0.5), 0.5 * f * f * (f - 1.0)}) {
        one.weight.push_back(static_cast<float>(weight));
      }
    }
  }
  return taps;
}

int FirstOf(const std::vector<Taps>& taps) {
  return std::min_element(taps.begin(), taps.end(), [](const Taps& a, const Taps& b) { return a.first < b.first; })->first;
}

int EndOf(const std::vector<Taps>& taps) {
  int end = taps.front().first;
  for (const Taps& one : taps) end = std::max(end, one.first + static_cast<int>(one.weight.size()));
  return end;
}

}  // namespace

MapPart ReadPart(const gis::MapReader& reader, int column, int row, int width, int height) {
  const image::ImageF cells = reader.Read(column, row, width, height);
  MapPart part{image::ImageF(width, height, 3), image::Image8(width, height, 1)};
  const int channels = cells.channels, colours = channels >= 3 ? 3 : 1;
  const bool has_alpha = channels == 2 || channels == 4;
  for (size_t i = 0; i < part.known.data.size(); ++i) {
    const float* const cell = &cells.data[i * static_cast<size_t>(channels)];
    if (!std::isfinite(cell[0]) || (has_alpha && !(cell[channels - 1] >= kOpaque))) continue;
    part.known.data[i] = 1;
    for (size_t c = 0; c < 3; ++c) part.rgb.data[3 * i + c] = cell[colours == 3 ? c : 0] / 255.0F;
  }
  return part;
}

TrueMap::TrueMap(const std::filesystem::path& truth_tif, const gis::MapGrid& grid) : reader_(truth_tif), grid_(grid) {
  constexpr const char* kSimulateSurveyAgain = "Make the survey again with 'skyquilt simulate'";
  const gis::MapGrid& truth = reader_.grid();
  if (truth.georeferenced != grid.georeferenced || (grid.georeferenced && truth.zone.Epsg() != grid.zone.Epsg())) {
    throw base::InputError(truth_tif, "is not in the zone of the orthophoto", kSimulateSurveyAgain);
  }
  const auto right = [](const gis::MapGrid& map) { return map.left + map.resolution_m * map.width; };
  const auto bottom = [](const gis::MapGrid& map) { return map.top - map.resolution_m * map.height; };
  if (truth.left >= right(grid) || grid.left >= right(truth) || truth.top <= bottom(grid) || grid.top <= bottom(truth)) {
    throw base::InputError(truth_tif, "does not overlap the orthophoto", kSimulateSurveyAgain);
  }
}

MapPart TrueMap::Read(int column, int row, int width, int height, const Eigen::Vector2d& shift_m) const {
  const gis::MapGrid& truth = reader_.grid();
  const double step = grid_.resolution_m / truth.resolution_m;
  const std::vector<Taps> across = TapsOf((grid_.left + column * grid_.resolution_m - shift_m.x() - truth.left) / truth.resolution_m, step, width);
  const std::vector<Taps> down = TapsOf((truth.top - grid_.top + row * grid_.resolution_m + shift_m.y()) / truth.resolution_m, step, height);
  const int left = FirstOf(across), top = FirstOf(down);
  MapPart source = ReadPart(reader_, left, top, EndOf(across) - left, EndOf(down) - top);
  const bool light = step > 1.0 + kNoWeight;
  if (light) {
    for (float& value : source.rgb.data) value = image::LinearFromSrgb(value);
  }
  // Along rows first, four values a cell: colours and how much of the weight is of cells with data.
  const int rows = source.rgb.height;
  image::ImageF narrowed(width, rows, 4);
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < width; ++x) {
      const Taps& taps = across[static_cast<size_t>(x)];
      float* const out = narrowed.At(x, y);
      for (size_t k = 0; k < taps.weight.size(); ++k) {
        const int from = taps.first - left + static_cast<int>(k);
        const float* const rgb = source.rgb.At(from, y);
        for (int c = 0; c < 3; ++c) out[c] += taps.weight[k] * rgb[c];
        out[3] += taps.weight[k] * static_cast<float>(*source.known.At(from, y));
      }
    }
  }
  MapPart part{image::ImageF(width, height, 3), image::Image8(width, height, 1)};
  for (int y = 0; y < height; ++y) {
    const Taps& taps = down[static_cast<size_t>(y)];
    for (int x = 0; x < width; ++x) {
      std::array<float, 4> sum{};
      for (size_t k = 0; k < taps.weight.size(); ++k) {
        const float* const value = narrowed.At(x, taps.first - top + static_cast<int>(k));
        for (size_t c = 0; c < 4; ++c) sum[c] += taps.weight[k] * value[c];
      }
      if (std::abs(sum[3] - 1.0F) > 1e-3F) continue;
      *part.known.At(x, y) = 1;
      for (size_t c = 0; c < 3; ++c) part.rgb.At(x, y)[c] = light ? image::SrgbFromLinear(sum[c]) : sum[c];
    }
  }
  return part;
}

}  // namespace skyquilt::evaluate::ortho
