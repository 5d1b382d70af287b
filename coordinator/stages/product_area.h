// Which area the products of a project cover.
#pragma once

#include "coordinator/stages/pipeline.h"
#include "products/product_options.h"

namespace skyquilt::coordinator {

// pipeline.settings.products; where stage "masks" ignored ground, their boundary leaves it out: nothing was learnt about it. That boundary is written
// to product_area.geojson beside the masks. Throws base::InputError as gis::Boundary::Read and gis::WriteAreaWithout.
products::ProductOptions OptionsOfProducts(const Pipeline& pipeline);

}  // namespace skyquilt::coordinator
