// Points of made buildings as the fused surface of a survey shows them: roofs with overhangs, rims, walls set back where few views saw them, ground.
#pragma once

#include <cstdint>

#include "buildings/building.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

struct SurfacePlan {
  double gsd_m = 0.1;
  double spacing_m = 0.25;
  double overhang_m = 0.4;     // of pitched parts
  double noise_m = 0.05;       // white, along the normal
  double waves_m = 0.0;        // correlated, per plane or wall
  double wave_length_m = 1.0;  // standard deviation of the Gaussian whose square root the correlation is
  double parapet_m = 0.0;      // above flat roofs, 0.25 m thick
  bool walls = true;           // also rims
  bool under = false;          // walls are seen up to the roof, by photos from below the eaves, which then show no rim
  int wall_views = 20;         // of 20 that see the roof
  uint64_t seed = 1;
};

struct MadeSurface {
  PointCloud cloud;
  Candidate candidate;
};
MadeSurface SurfaceOf(const Shape& shape, const SurfacePlan& plan = {});

// A part between walls 0 and length, 0 and width, on axes turned by yaw; flat when ridge_z == eave_z.
Shape OnePart(RoofKind roof, double length, double width, double eave_z, double ridge_z, double yaw_rad = 0.0);
// The same with all lines, heights and yaw moved by up to these amounts.
Shape Disturbed(const Shape& shape, double line_m, double height_m, double yaw_rad, uint64_t seed);

}  // namespace skyquilt::buildings
