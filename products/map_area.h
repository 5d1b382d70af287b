// The part of a scene that maps and surface cover: all of it, or what the user's boundary leaves.
#pragma once

#include <optional>

#include "core/gis/boundary.h"
#include "core/gis/map_grid.h"
#include "products/product_options.h"

namespace skyquilt::products {

// The polygons of options.boundary in the grid's coordinates; none when no file is given. Throws base::InputError when the file cannot be used,
// base::UsageError when the polygons do not meet the grid.
std::optional<gis::Boundary> BoundaryOf(const gis::MapGrid& grid, const ProductOptions& options);
// The cells of the grid inside the boundary's bounding box, which must meet the grid.
gis::MapGrid CropTo(const gis::MapGrid& grid, const gis::Boundary& boundary);

}  // namespace skyquilt::products
