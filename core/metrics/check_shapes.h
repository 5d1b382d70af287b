// Checks the sizes of the images to be compared, for all metrics. Throws std::logic_error when they differ.
#pragma once

#include <string>

#include "core/base/errors.h"
#include "core/image/image.h"

namespace skyquilt::metrics {

template <typename T>
std::string ShapeText(const image::BasicImage<T>& image) {
  return std::to_string(image.width) + "x" + std::to_string(image.height) + "x" + std::to_string(image.channels);
}

inline void CheckShapes(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask) {
  SKYQUILT_CHECK(a.width == b.width && a.height == b.height && a.channels == b.channels, ShapeText(a) + " against " + ShapeText(b));
  if (mask == nullptr) return;
  SKYQUILT_CHECK(mask->width == a.width && mask->height == a.height && mask->channels == 1, "mask " + ShapeText(*mask) + " for " + ShapeText(a));
}

}  // namespace skyquilt::metrics
