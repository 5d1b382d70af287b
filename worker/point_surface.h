// The ground as the sparse points tell it.
#pragma once

#include "core/scene/plan_surface.h"
#include "core/survey/survey.h"

namespace skyquilt::worker {

// Median heights of the sparse points on a coarse grid, continued smoothly to where there are none. Empty without points.
scene::PlanSurface SurfaceOfPoints(const survey::Survey& survey);

}  // namespace skyquilt::worker
