// Reads a GPS log in GPX 1.0 or 1.1 (topografix.com/GPX/1/1): the points of all its tracks that have a time. Elevations are above sea level by what
// the receiver thinks.
#pragma once

#include <filesystem>

#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

// Times are UTC (FlightTrack::by_clock). No points: none has a time. Throws base::InputError for what is no GPX.
FlightTrack ReadGpx(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::video
