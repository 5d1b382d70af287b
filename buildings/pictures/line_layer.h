// Anti-aliased lines, collected as coverage of pixels and then blended at once, so that overlapping pieces of a line do not grow darker.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/image/image.h"

namespace skyquilt::buildings {

class LineLayer {
 public:
  LineLayer(int width, int height);

  // From a to b with round ends. Pixels: the image corner is (0, 0), the centre of the first pixel (0.5, 0.5). Parts outside are cut off.
  void Add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double width_px);
  // image: RGB of the size of the layer. opacity: 0 to 1, of fully covered pixels.
  void BlendInto(image::Image8* image, const std::array<uint8_t, 3>& rgb, double opacity) const;

 private:
  int width_, height_;
  std::vector<float> coverage_;  // 0 to 1, row-major
};

}  // namespace skyquilt::buildings
