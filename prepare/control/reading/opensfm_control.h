// Reads OpenSfM's ground_control_points.json (opensfm.org/docs/gcp.html): points with "id", "position" (latitude, longitude in degrees, altitude in
// metres, taken as ellipsoidal) and "observations" (shot_id and projection: from the image's middle, in parts of its larger side).
#pragma once

#include <filesystem>

#include "prepare/control/reading/raw_control.h"

namespace skyquilt::prepare::control {

// Throws base::InputError with the line and how to fix it.
RawControl ReadOpensfmControl(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::control
