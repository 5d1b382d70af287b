#include "bench/study/class_crop.h"

#include <algorithm>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::bench {

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
