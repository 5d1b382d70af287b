// Classes of surface points, as in the source paper: ground, roof, wall, edge, corner, vegetation, other.
#pragma once

#include <cstdint>
#include <vector>

#include "buildings/building.h"
#include "buildings/buildings_options.h"
#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

enum class PointClass : uint8_t { kOther, kGround, kRoof, kWall, kEdge, kCorner, kVegetation };
inline constexpr int kPointClasses = 7;
const char* NameOf(PointClass point_class);  // "other", "ground", ...
// Code in LAS files: other 1, ground 2, vegetation 5, roof 6 (ASPRS "building"), and of the range free for users wall 64, edge 65, corner 66.
uint8_t LasCode(PointClass point_class);

// Ground: within 0.3 m + 1 GSD of the bare ground, but not the foot of a wall, nor what is more than 2 GSD inside a footprint.
// Of points within 3 GSD of a building's solid (lod22): corner within 2 GSD of a vertex where at least three faces meet at angles, edge within 2 GSD
// of an edge whose faces meet at more than 20 degrees, else roof or wall as the nearest face and the normal say. Edges at the ground do not count.
// Pitched roofs are continued over Building::overhang_m: their edges and corners are where the overhang ends, not above the walls. Green points whose
// normals fit no near face are vegetation. Other points inside a footprint and above min_height / 2 (parapets, chimneys, boxes, roofs that the solid
// does not follow) are roof or wall by their normal, and vegetation when green and scattered. Vegetation: the rest above min_height / 2 that is green
// or scattered. One class per point of the cloud, the same for any number of threads. Throws base::Interrupted.
std::vector<PointClass> ClassifyPoints(const PointCloud& cloud, const GroundGrid& ground, const BuildingSet& set, const BuildingsOptions& options,
                                       base::ThreadPool& threads);

}  // namespace skyquilt::buildings
