// The texture as a picture.
#pragma once

#include "core/image/image.h"
#include "surface/texture/texel_colors.h"

namespace skyquilt::surface {

// Each chart's rectangle with its gutter is filled: texels of unknown colour, and those around the chart, with means of their neighbours, outwards
// from the known ones, so that interpolation and the blocks of a JPEG mix nothing foreign in. A chart without any known colour is grey (128), and
// what belongs to no chart has the mean colour.
image::Image8 PaintAtlas(const AtlasLayout& layout, const AtlasTexels& texels, const TexelColors& colors, base::ThreadPool& threads);

}  // namespace skyquilt::surface
