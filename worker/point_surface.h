// The ground as the sparse points tell it.
#pragma once

#include "core/scene/height_map.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

// Median heights of the sparse points on a coarse grid, continued smoothly to where there are none. Empty without points.
scene::HeightMap SurfaceOfPoints(const survey::Survey& survey);

}  // namespace skyquilt::worker
