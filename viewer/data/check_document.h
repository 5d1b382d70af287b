// Checks of what browsers want to save. Everything in it is untrusted.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <stdexcept>
#include <string>

#include "core/geo/geodetic.h"

namespace skyquilt::viewer {

// What is wrong with a document, for the user.
class Refused : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// All throw Refused.

// Not JSON, or nested deeper than 32: programs that read it, ours among them, follow the nesting on their stack.
nlohmann::json ParseDocument(const std::string& text);
// A number that is finite and at most 1e9. `where` names it.
void RequireNumber(const nlohmann::json& value, const std::string& where);
// A text of 1 to max_bytes bytes without control characters.
void RequireLine(const nlohmann::json& value, size_t max_bytes, const std::string& where);

// A FeatureCollection of at most 5000 points, lines and polygons. Properties and members that we do not know are allowed.
void CheckMeasurements(const nlohmann::json& json);
// What `skyquilt render --path` accepts for a scene with this place, of at most 200,000 frames. text: the document.
void CheckCameraPath(const nlohmann::json& json, const std::string& text, const geo::Geodetic& origin, bool georeferenced);
// Whether it is a camera path without views, which `render --path` would refuse.
bool IsEmptyPath(const nlohmann::json& json);

}  // namespace skyquilt::viewer
