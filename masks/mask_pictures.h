// Joins the masks of one photo, and shows them.
#pragma once

#include <cstdint>

#include "core/image/image.h"

namespace skyquilt::masks {

// Masks of one photo; each empty (the photo has none) or of the photo's size: one channel, 0 = ignored.
struct MaskParts {
  image::Image8 given, network, ground;
};

struct JoinedMask {
  image::Image8 mask;                                       // 0 where any part is 0, else 255
  int64_t ignored = 0, given = 0, network = 0, ground = 0;  // pixels that are 0
  bool differs = false;                                     // from the given mask
};

JoinedMask Join(const MaskParts& parts, int width, int height);

// The photo, at most `width` pixels wide, with what is ignored tinted: red by the network, blue on ignored ground, grey by the given mask; the first
// of these that holds. rgb: the photo at any size of its shape.
image::Image8 LookPicture(const image::Image8& rgb, const MaskParts& parts, int width);

}  // namespace skyquilt::masks
