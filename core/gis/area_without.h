// The area that products cover, less what is to be left out of them.
#pragma once

#include <filesystem>
#include <optional>

#include "core/gis/boundary.h"
#include "core/gis/map_projection.h"

namespace skyquilt::gis {

// Writes polygons as GeoJSON for Boundary::Read: `area`, or without one the rectangle `all`, less what is inside `holes`. All in map coordinates;
// zone: theirs, without geo-reference local metres. Throws base::InputError when nothing is left, or the file cannot be written.
void WriteAreaWithout(const std::optional<Boundary>& area, const MapExtent& all, const Boundary& holes, bool georeferenced, const geo::UtmZone& zone,
                      const std::filesystem::path& file);

}  // namespace skyquilt::gis
