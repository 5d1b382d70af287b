// Structural similarity (Wang et al. 2004), which compares local contrast and structure instead of single pixels; at most 1, higher is better.
// Gaussian window 11x11 with sigma 1.5, K1 = 0.01, K2 = 0.03, L = 1, averaged over channels.
//   a, b   equal shapes, any number of channels, display values in [0,1]
//   mask   one channel of the images' size, 0: ignore; null: every pixel counts
//   map    if not null: one channel of the images' size, NaN where nothing was scored
// A pixel is scored when it is not ignored and its window is inside the image ("valid" border of 5 pixels, as in the authors' code).
// Ignored pixels have no influence: the window's weights on the other pixels are scaled to sum to 1. Without a mask this is the usual SSIM.
// Moments are in double. Nothing scored (also images smaller than 11x11) gives NaN. Memory: 11 rows in addition to the images.
// Wrong shapes throw std::logic_error.
#pragma once

#include "core/image/image.h"

namespace skyquilt::metrics {

// Mean over the scored pixels; 1 for identical images.
double Ssim(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask, image::ImageF* map = nullptr);

}  // namespace skyquilt::metrics
