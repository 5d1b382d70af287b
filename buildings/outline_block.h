// Buildings without right angles: a block that follows the outline of the roof.
#pragma once

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "core/geo/place_accuracy.h"

namespace skyquilt::buildings {

// Whether the outline leaves more than a tenth of its shape's rectangle empty, so that the rectangle would be too large: polygons, circles, wedges.
bool LeavesCorners(const Candidate& candidate, const Shape& shape);

// Replaces footprint, solids, areas and volume of a building by those of a block between the ground and the level roof of its largest part, whose
// outline is the candidate's, simplified. Length and width stay those of the rectangle. Areas get a standard deviation of half a GSD along the whole
// outline, since all of its rim errs to the same side, and that of the survey's scale (accuracy; unknown parts do not count).
void FollowOutline(const Candidate& candidate, double gsd_m, const geo::PlaceAccuracy& accuracy, Building* building);

}  // namespace skyquilt::buildings
