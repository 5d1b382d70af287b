// A first estimate of the ground's surface from the sparse points, before any field is trained.
#pragma once

#include "core/scene/height_map.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

// Median heights of the sparse points on a coarse grid, interpolated smoothly where there are no points. Survey ENU, metres. Empty without points.
scene::HeightMap SurfaceOfPoints(const survey::Survey& survey);

}  // namespace skyquilt::worker
