// FLIP (Andersson et al. 2020, LDR-FLIP): the difference that a person sees who flips between two images on a screen. From 0 (identical) to 1, lower
// is better. It needs no trained network. The observer is 0.7 m from a screen of 3840 pixels on 0.7 m, which is 67 pixels per degree.
// Two parts are compared: colours, after blurring each opponent channel as the eye does at this distance, and edges and points of luminance. An
// error of colour counts more where edges or points differ too.
//   a, b   RGB display values, clamped to [0,1]; equal sizes. The two may be exchanged: the result is the same, bit by bit
//   mask   one channel of the images' size, 0: ignore; null: every pixel counts
//   map    if not null: one channel of the images' size, the error per pixel, NaN where the mask ignores
// Ignored pixels have no influence: both images are mid-grey (0.5) there. Beyond the border the images repeat their outermost pixels.
// Mean over the pixels that count; nothing to count gives NaN, and so does a NaN in a pixel that counts.
// The same bits for any number of threads. Memory: about 6 kB per column of the image for each thread, in addition to the images.
// Wrong shapes throw std::logic_error.
#pragma once

#include "core/base/thread_pool.h"
#include "core/image/image.h"

namespace skyquilt::metrics {

double Flip(const image::ImageF& a, const image::ImageF& b, const image::Image8* mask, base::ThreadPool& threads, image::ImageF* map = nullptr);

}  // namespace skyquilt::metrics
