#include "core/brightness/unshade.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/image/srgb.h"

namespace skyquilt::brightness {

void DivideByShading(const PhotoShading& shading, size_t photo, image::Image8& rgb) {
  const size_t knots = shading.grid.knots();
  if (shading.log_shading.size() < (photo + 1) * knots || knots == 0) return;
  const float* const of_photo = shading.log_shading.data() + photo * knots;
  if (std::all_of(of_photo, of_photo + knots, [](float value) { return value == 0.0F; })) return;
  std::array<float, 256> light{};
  for (size_t i = 0; i < light.size(); ++i) light[i] = image::LinearFromSrgb(static_cast<float>(i) / 255.0F);
  for (int y = 0; y < rgb.height; ++y) {
    for (int x = 0; x < rgb.width; ++x) {
      const KnotWeights at = KnotsAt(shading.grid, {(static_cast<float>(x) + 0.5F) / static_cast<float>(rgb.width),
                                                    (static_cast<float>(y) + 0.5F) / static_cast<float>(rgb.height)});
      float sum = 0.0F;
      for (size_t i = 0; i < at.knot.size(); ++i) sum += at.weight[i] * of_photo[at.knot[i]];
      const float factor = std::exp(-sum);
      uint8_t* const pixel = rgb.At(x, y);
      for (size_t c = 0; c < 3; ++c) {
        const float value = image::SrgbFromLinear(std::min(1.0F, factor * light[pixel[c]]));
        pixel[c] = static_cast<uint8_t>(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F)));
      }
    }
  }
}

}  // namespace skyquilt::brightness
