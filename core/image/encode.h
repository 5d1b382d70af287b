// Images as file bytes in memory, for those who send them instead of writing files. JPEG: EncodeJpeg in core/image/image.h.
#pragma once

#include <string>

#include "core/image/image.h"

namespace skyquilt::image {

// The fastest compression that still halves pictures: one filter and runs of equal bytes.
constexpr int kFastPng = 0;
// Grey, RGB or RGBA (alpha not premultiplied). level: kFastPng, or 1 to 9 (smallest and slowest). Throws std::logic_error for an empty image or
// another number of channels.
std::string EncodePng(const Image8& image, int level);

}  // namespace skyquilt::image
