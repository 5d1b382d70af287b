// Reduces an image as a coarser camera would: each pixel becomes the mean of the area that it covers.
#pragma once

#include "core/image/image.h"

namespace skyquilt::image {

// Means of the values as they are: give linear light for light, because a mean of sRGB values is too dark. width and height: 1 to those of the image;
// pixels at the border of an area count by their share in it. Throws std::logic_error for other sizes.
ImageF AreaMean(const ImageF& image, int width, int height);

}  // namespace skyquilt::image
