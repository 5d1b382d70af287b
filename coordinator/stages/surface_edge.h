// Where the surface of a survey ends.
#pragma once

#include <optional>

#include "core/gis/boundary.h"
#include "core/gis/map_grid.h"
#include "core/scene/background.h"
#include "core/scene/scene.h"

namespace skyquilt::coordinator {

// Outline of the ground that at least `photos` training photos see (products/photo_map/map_edge.h), in the coordinates of the grid. Where surveys
// overlap little, fewer count, but at least two, until the outline has four fifths of the area that two photos see. Nothing when that area is empty
// or not known, as where photos look level.
std::optional<gis::Boundary> SurfaceEdge(const scene::Background& background, const scene::SceneInfo& info, const gis::MapGrid& grid, int photos);

}  // namespace skyquilt::coordinator
