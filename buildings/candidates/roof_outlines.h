// Outlines of buildings from planar pieces of roofs and the surface seen from above.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "buildings/buildings_options.h"
#include "buildings/candidates/piece_kind.h"
#include "buildings/candidates/top_raster.h"

namespace skyquilt::buildings {

// Height of the nearest piece's plane at each cell, and which piece that is; NaN and -1 when there are no pieces.
struct RoofLevels {
  std::vector<float> z;
  std::vector<int32_t> piece;     // index into the pieces
  std::vector<float> distance_m;  // to the nearest point of a piece
};
RoofLevels FindRoofLevels(const TopRaster& top, std::span<const PlanePiece> pieces, const PointCloud& cloud, double max_green);

// A building seen from above, on its own part of the raster with kAround_m on all sides where the raster reaches so far.
struct RoofArea : geo::PlaneGrid {
  CellMask mask;
  std::vector<float> roof_z;   // RoofLevels::z
  std::vector<int32_t> piece;  // RoofLevels::piece
};
inline constexpr double kAround_m = 3.5;
RoofArea CutOut(const TopRaster& top, const RoofLevels& levels, const std::vector<uint32_t>& cells);

// Buildings in the order of their first cells: connected cells near the pieces where the surface is as high as the roof, without strips narrower than
// 1 m, at least options.min_area_m2. What stands on a roof belongs to it; holes that reach down to the ground stay.
std::vector<RoofArea> FindRoofAreas(const TopRaster& top, const RoofLevels& levels, std::span<const PlanePiece> pieces,
                                    const BuildingsOptions& options, double gsd_m, double spacing_m);
// How far the surface may lie below a piece's plane and still be its roof.
double RoofTolerance(double gsd_m);

}  // namespace skyquilt::buildings
