#include "bench/study/picture_sheet.h"

#include <algorithm>

#include "core/image/draw_text.h"

namespace skyquilt::bench {
namespace {

constexpr int kGap_px = 10;
constexpr double kCapital_px = 11.0;

}  // namespace

image::Image8 EnlargedPart(const image::Image8& image, const PicturePart& part, int times) {
  const int w = std::min(part.width, image.width), h = std::min(part.height, image.height);
  const int left = std::clamp(part.left, 0, image.width - w), top = std::clamp(part.top, 0, image.height - h);
  image::Image8 enlarged(w * times, h * times, image.channels);
  for (int y = 0; y < enlarged.height; ++y) {
    for (int x = 0; x < enlarged.width; ++x) std::copy_n(image.At(left + x / times, top + y / times), image.channels, enlarged.At(x, y));
  }
  return enlarged;
}

image::Image8 EnlargedMiddle(const image::Image8& image, int width, int height, int times) {
  return EnlargedPart(image, {(image.width - width) / 2, (image.height - height) / 2, width, height}, times);
}

image::Image8 PictureSheet(const std::vector<std::vector<CaptionedImage>>& rows) {
  const int caption_px = static_cast<int>(2.0 * kCapital_px);
  int width = kGap_px, height = kGap_px;
  for (const auto& row : rows) {
    int row_width = kGap_px, row_height = 0;
    for (const CaptionedImage& cell : row) {
      row_width += std::max(cell.image.width, image::TextWidth(cell.caption, kCapital_px)) + kGap_px;
      row_height = std::max(row_height, cell.image.height);
    }
    width = std::max(width, row_width);
    height += caption_px + row_height + kGap_px;
  }
  image::Image8 sheet(width, height, 3, 255);
  int top = kGap_px;
  for (const auto& row : rows) {
    int left = kGap_px, row_height = 0;
    for (const CaptionedImage& cell : row) {
      image::DrawText(&sheet, cell.caption, left, top + static_cast<int>(1.3 * kCapital_px), kCapital_px);
      for (int y = 0; y < cell.image.height; ++y) std::copy_n(cell.image.At(0, y), cell.image.width * 3, sheet.At(left, top + caption_px + y));
      left += std::max(cell.image.width, image::TextWidth(cell.caption, kCapital_px)) + kGap_px;
      row_height = std::max(row_height, cell.image.height);
    }
    top += caption_px + row_height + kGap_px;
  }
  return sheet;
}

}  // namespace skyquilt::bench
