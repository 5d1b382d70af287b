// Writes tour.json.
#pragma once

#include <string>

#include "tour/format/tour.h"

namespace skyquilt::tour {

// All members in the order of docs/tour_format.md; indented, unless it would be longer than 1 MiB then. ParseTour gives the same tour again.
std::string FormatTour(const Tour& tour);

}  // namespace skyquilt::tour
