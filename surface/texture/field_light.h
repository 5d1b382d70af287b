// Brings the photos of a texture into the light of the field.
#pragma once

#include "surface/texture/photo_texture.h"

namespace skyquilt::surface {

// Multiplies the linear light of each photo so that around each cell (a normal curve with a standard deviation of two cells) its mean is the field's:
// what is coarser than about 20 texels then comes from the field, what is finer from the photo. field: of the cells, in their order. Same bits for
// any number of threads.
void BringIntoFieldLight(const AtlasLayout& layout, const AtlasTexels& texels, const TexelColors& field, base::ThreadPool& threads,
                         PhotoTexture* texture);

}  // namespace skyquilt::surface
