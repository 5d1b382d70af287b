// Checks of what browsers want to save. Everything in it is untrusted.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/geo/geodetic.h"

namespace skyquilt::viewer {

// All throw base::Refused.

// A FeatureCollection of at most 5000 points, lines and polygons. Properties and members that we do not know are allowed.
void CheckMeasurements(const nlohmann::json& json);
// What `skyquilt render --path` accepts for a scene with this place, of at most 200,000 frames. text: the document.
void CheckCameraPath(const nlohmann::json& json, const std::string& text, const geo::Geodetic& origin, bool georeferenced);
// Whether it is a camera path without views, which `render --path` would refuse.
bool IsEmptyPath(const nlohmann::json& json);

}  // namespace skyquilt::viewer
