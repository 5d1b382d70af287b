#include "worker/robust/cell_picture.h"

#include <algorithm>
#include <cmath>

#include "core/image/srgb.h"

namespace skyquilt::worker {
namespace {

constexpr float kTooBright = 250.0F;  // mean recorded value of a cell

}  // namespace

int CellPicture::Range::Outside(const std::array<uint8_t, 3>& rgb) const {
  int most = 0;
  for (size_t c = 0; c < 3; ++c) most = std::max({most, low[c] - rgb[c], rgb[c] - high[c]});
  return most;
}

CellPicture::Range CellPicture::RangeAround(int column, int row) const {
  Range range;
  for (int v = std::max(0, row - 1); v <= std::min(rows - 1, row + 1); ++v) {
    for (int u = std::max(0, column - 1); u <= std::min(columns - 1, column + 1); ++u) {
      const Cell& cell = At(u, v);
      range.usable = range.usable && cell.usable == 1;
      for (size_t c = 0; c < 3; ++c) {
        range.low[c] = std::min(range.low[c], cell.rgb[c]);
        range.high[c] = std::max(range.high[c], cell.rgb[c]);
      }
    }
  }
  return range;
}

CellPicture MakeCellPicture(const RaySource& source, const image::PixelCache& pixels, const brightness::Response& response, int photo, int cell_px) {
  const auto index = static_cast<size_t>(photo);
  const int width = pixels.Width(index), height = pixels.Height(index);
  const image::PixelCache::Photo recorded = pixels.Copy(index);
  CellPicture picture;
  picture.columns = (width + cell_px - 1) / cell_px;
  picture.rows = (height + cell_px - 1) / cell_px;
  picture.cells.resize(static_cast<size_t>(picture.columns) * static_cast<size_t>(picture.rows));
  for (int row = 0; row < picture.rows; ++row) {
    for (int column = 0; column < picture.columns; ++column) {
      CellPicture::Cell& cell = picture.cells[static_cast<size_t>(row) * static_cast<size_t>(picture.columns) + static_cast<size_t>(column)];
      const int end_x = std::min(width, (column + 1) * cell_px), end_y = std::min(height, (row + 1) * cell_px);
      std::array<float, 3> sum{};
      int n = 0;
      bool masked = false;
      for (int y = row * cell_px; y < end_y && !masked; ++y) {
        for (int x = column * cell_px; x < end_x && !masked; ++x, ++n) {
          const size_t pixel = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
          masked = !recorded.mask.empty() && recorded.mask[pixel] == 0;
          for (size_t c = 0; c < 3; ++c) sum[c] += static_cast<float>(recorded.rgb[3 * pixel + c]);
        }
      }
      if (masked) continue;
      const Eigen::Vector2d middle(0.5 * (column * cell_px + end_x), 0.5 * (row * cell_px + end_y));
      const std::array<brightness::Exposure, 3> exposure = response.ExposureOf(index, source.Radius2(photo, middle), source.PlaceOf(photo, middle));
      cell.usable = 1;
      for (size_t c = 0; c < 3; ++c) {
        const float mean = sum[c] / static_cast<float>(n);
        if (mean > kTooBright) cell.usable = 2;
        const float value = image::SrgbFromLinear(image::LinearFromSrgb(mean / 255.0F) / exposure[c].gain);
        cell.rgb[c] = static_cast<uint8_t>(std::clamp(std::lround(CellPicture::kUnits * value), 0L, 255L));
      }
    }
  }
  return picture;
}

}  // namespace skyquilt::worker
