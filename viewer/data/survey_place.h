// Where a survey's ENU frame lies, and how two of them lie to each other.
#pragma once

#include <optional>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"

namespace skyquilt::viewer {

struct SurveyPlace {
  geo::Geodetic origin;
  bool georeferenced = false;
};

// The rigid transform of coordinates in `main` to those in `other`. Two local frames without geo-reference count as the same one. Nothing when only
// one has a geo-reference, or an origin is not on Earth.
std::optional<geo::Rigid3d> OtherFromMain(const SurveyPlace& main, const SurveyPlace& other);

}  // namespace skyquilt::viewer
