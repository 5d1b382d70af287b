// Rendered colours as an image.
#pragma once

#include <span>

#include "core/image/image.h"
#include "core/scene/scene.h"

namespace skyquilt::evaluate::photos {

// colors: row-major, width * height; clamped to [0, 1], black for NaN.
image::Image8 PictureOf(std::span<const render::RayColor> colors, int width, int height);

}  // namespace skyquilt::evaluate::photos
