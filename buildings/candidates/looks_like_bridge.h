// Whether a raised surface is the deck of a bridge or ramp rather than a roof.
#pragma once

#include "buildings/candidates/roof_outlines.h"
#include "buildings/candidates/survey_edge.h"
#include "buildings/candidates/top_raster.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

// A deck runs on at both ends: at two opposite sides, over at least half of its width, the surface beyond continues at its height and is no higher
// than min_height_m above the bare ground. One of the ends may be where the survey ends. A house whose roof meets a slope does so on one side. area:
// cut out of top.
bool LooksLikeBridge(const RoofArea& area, const TopRaster& top, const GroundGrid& ground, const SurveyEdge& edge, double min_height_m);

}  // namespace skyquilt::buildings
