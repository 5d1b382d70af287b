// Definitions of coordinate systems as text, for files that hold them.
#pragma once

#include <string>

#include "core/geo/utm.h"

namespace skyquilt::gis {

// OGC well-known text, version 1 (OGC 01-009): PROJCS[...] of a UTM or UPS zone, with its EPSG code. Throws base::InputError when PROJ does not know
// it.
std::string WktOfZone(const geo::UtmZone& zone);

}  // namespace skyquilt::gis
