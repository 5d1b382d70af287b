#include "bench/poses/photo_edits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::bench {

image::Image8 TurnedClockwise(const image::Image8& photo) {
  image::Image8 turned(photo.height, photo.width, photo.channels);
  for (int y = 0; y < photo.height; ++y) {
    for (int x = 0; x < photo.width; ++x) std::copy_n(photo.At(x, y), photo.channels, turned.At(photo.height - 1 - y, x));
  }
  return turned;
}

geo::Rigid3d TurnedClockwise(const geo::Rigid3d& cam_from_world) {
  // x becomes y, and y becomes -x.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitZ()));
  return {turn * cam_from_world.rotation, turn * cam_from_world.translation};
}

image::Image8 MovedWhileOpen(const image::Image8& photo, int length_px) {
  SKYQUILT_CHECK(length_px >= 1, "blur of " + std::to_string(length_px) + " pixels");
  image::Image8 blurred(photo.width, photo.height, photo.channels);
  std::vector<int> sum(static_cast<size_t>(photo.height) + 1);
  for (int x = 0; x < photo.width; ++x) {
    for (int c = 0; c < photo.channels; ++c) {
      for (int y = 0; y < photo.height; ++y) sum[static_cast<size_t>(y) + 1] = sum[static_cast<size_t>(y)] + photo.At(x, y)[c];
      for (int y = 0; y < photo.height; ++y) {
        const int first = std::max(0, y - length_px / 2), end = std::min(photo.height, y - length_px / 2 + length_px);
        const int total = sum[static_cast<size_t>(end)] - sum[static_cast<size_t>(first)];
        blurred.At(x, y)[c] = static_cast<uint8_t>(std::lround(static_cast<double>(total) / (end - first)));
      }
    }
  }
  return blurred;
}

image::Image8 MiddleOf(const image::Image8& photo, int width, int height) {
  SKYQUILT_CHECK(width >= 1 && height >= 1 && width <= photo.width && height <= photo.height, "size of the middle");
  SKYQUILT_CHECK((photo.width - width) % 2 == 0 && (photo.height - height) % 2 == 0, "the middle would move");
  image::Image8 middle(width, height, photo.channels);
  const int left = (photo.width - width) / 2, top = (photo.height - height) / 2;
  for (int y = 0; y < height; ++y) std::copy_n(photo.At(left, top + y), width * photo.channels, middle.At(0, y));
  return middle;
}

}  // namespace skyquilt::bench
