// Writes labels into pictures that are shown outside pages.
#pragma once

#include <string>

#include "core/image/image.h"

namespace skyquilt::image {

// Plain ASCII in black on the image (RGB), with its lower left corner at (x, y); parts beyond the image are cut off. height_px: of capital letters.
void DrawText(Image8* image, const std::string& text, int x, int y, double height_px);
// Width of the text in pixels.
int TextWidth(const std::string& text, double height_px);

}  // namespace skyquilt::image
