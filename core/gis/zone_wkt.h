// Definitions of coordinate systems as text, for files that hold them.
#pragma once

#include <string>

#include "core/geo/height_reference.h"
#include "core/geo/utm.h"

namespace skyquilt::gis {

// OGC well-known text, version 1 (OGC 01-009): PROJCS[...] of a UTM or UPS zone, with its EPSG code; with known heights COMPD_CS[PROJCS[...],
// VERT_CS[...]], where heights above the ellipsoid have the datum type 2002, as LAS 1.4 wants it. Throws base::InputError when PROJ does not know it.
std::string WktOfZone(const geo::UtmZone& zone, geo::HeightReference heights = geo::HeightReference::kUnknown);

}  // namespace skyquilt::gis
