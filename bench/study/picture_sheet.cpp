#include "bench/study/picture_sheet.h"

#include <algorithm>

#include "core/base/errors.h"
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

ClassCrop CropWithMost(const image::Image8& classes, survey::SurfaceClass wanted, int width, int height) {
  SKYQUILT_CHECK(classes.channels == 1 && !classes.Empty() && width > 0 && height > 0, "class images have one channel");
  const int w = std::min(width, classes.width), h = std::min(height, classes.height);
  // Entry (x, y): number of pixels of the class above and left of the corner (x, y).
  const auto columns = static_cast<size_t>(classes.width) + 1;
  std::vector<int64_t> above_left(columns * (static_cast<size_t>(classes.height) + 1), 0);
  const auto at = [&](int x, int y) -> int64_t& { return above_left[static_cast<size_t>(y) * columns + static_cast<size_t>(x)]; };
  for (int y = 0; y < classes.height; ++y) {
    for (int x = 0; x < classes.width; ++x) {
      const int64_t here = *classes.At(x, y) == static_cast<uint8_t>(wanted) ? 1 : 0;
      at(x + 1, y + 1) = at(x + 1, y) + at(x, y + 1) - at(x, y) + here;
    }
  }
  const int middle_left = (classes.width - w) / 2, middle_top = (classes.height - h) / 2;
  const auto off_middle = [&](int left, int top) {
    const int64_t dx = left - middle_left, dy = top - middle_top;
    return dx * dx + dy * dy;
  };
  ClassCrop best{.part = {middle_left, middle_top, w, h}, .pixels = -1};
  for (int top = 0; top + h <= classes.height; ++top) {
    for (int left = 0; left + w <= classes.width; ++left) {
      const int64_t pixels = at(left + w, top + h) - at(left, top + h) - at(left + w, top) + at(left, top);
      const bool closer = off_middle(left, top) < off_middle(best.part.left, best.part.top);
      if (pixels > best.pixels || (pixels == best.pixels && closer)) best = {.part = {left, top, w, h}, .pixels = pixels};
    }
  }
  return best;
}

}  // namespace skyquilt::bench
