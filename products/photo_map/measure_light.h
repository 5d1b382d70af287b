// What light each photo of a map has.
#pragma once

#include "core/base/thread_pool.h"
#include "products/photo_map/map_nodes.h"

namespace skyquilt::products {

// From the field's colours where they are known, otherwise from what photos show of the same places. small: pictures with about a pixel per node.
PhotoLight MeasureLight(const PhotoMapInput& input, survey::PhotoPictures& small, base::ThreadPool& threads);

}  // namespace skyquilt::products
