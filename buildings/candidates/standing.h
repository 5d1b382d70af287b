// Whether a roof stands out of its surroundings as a building does.
#pragma once

#include "buildings/candidates/roof_outlines.h"
#include "buildings/candidates/top_raster.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

struct Standing {
  double drop = 0.0;         // share of the border beyond which the surface falls by at least half of the height above the ground within 1.2 m
  double high_around = 0.0;  // share of surface as high as buildings, in the band of 0.4 to 1.5 m around it
  double planar = 0.0;       // share of its cells at points of planes
};
// area: cut out of top, whose pieces levels were found for.
Standing MeasureStanding(const RoofArea& area, const TopRaster& top, const RoofLevels& levels, const GroundGrid& ground, double min_height_m);

// What has hardly any drop is a ghost at the edge of the survey, the sagging or rising surface of water, or a bank; what has small planes in the
// midst of other high surface is the crown of a tree that is not green. area_m2: of the outline; largest_m2: of its planes; n_wall: steep points.
bool LooksLikeBuilding(const Standing& standing, double area_m2, double largest_m2, size_t n_wall);

}  // namespace skyquilt::buildings
