// Sharpness of a picture from one straight edge between a dark and a bright area (slanted edge, ISO 12233).
#pragma once

#include "core/image/image.h"

namespace skyquilt::evaluate::ortho {

// The frequency, in cycles per pixel across the edge, at which the contrast falls to half of that of wide areas; a Gaussian blur of s pixels gives
// 0.187 / s. luminance: one channel, linear light, because optics and resampling blur light; with display values bright sides would look wider.
// The edge passes near the middle of the picture from one side to the opposite one, 2 to 25 degrees off rows or columns, and nothing else is
// in the picture. NaN where that cannot be: smaller than 16 x 16, without contrast, values that are not finite, an edge along rows or columns.
double SlantedEdgeMtf50(const image::ImageF& luminance);

}  // namespace skyquilt::evaluate::ortho
