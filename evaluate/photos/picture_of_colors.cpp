#include "evaluate/photos/picture_of_colors.h"

#include <algorithm>

#include "core/base/errors.h"

namespace skyquilt::evaluate::photos {

image::Image8 PictureOf(std::span<const render::RayColor> colors, int width, int height) {
  SKYQUILT_CHECK(colors.size() == static_cast<size_t>(width) * static_cast<size_t>(height), "one colour per pixel");
  image::ImageF picture(width, height, 3);
  for (size_t i = 0; i < colors.size(); ++i) std::copy_n(colors[i].rgb_srgb, 3, picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
  return image::ToImage8(picture);
}

}  // namespace skyquilt::evaluate::photos
