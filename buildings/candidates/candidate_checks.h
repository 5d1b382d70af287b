// What speaks for and against a candidate: whether its roof stands out of its surroundings as a building does, what points that were matched in
// photos say, and whether its planes are large enough for a roof.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "buildings/candidates/find_candidates.h"
#include "buildings/candidates/roof_outlines.h"
#include "buildings/candidates/top_raster.h"
#include "buildings/planes/grow_planes.h"
#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

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

// What points that were matched in photos say about a candidate: a second opinion that does not come from the field.
struct MatchedPoints {
  int low = 0;   // nearer to the ground than to the roof
  int high = 0;  // the others
  // Photos see the ground where the field has a roof: fog over a field or a wood. One wrong match proves nothing.
  bool DenyRoof() const { return low >= 3 && low >= 4 * high; }
};

// Counts for each candidate the points (ENU, metres) inside its outline, more than 0.5 m from it, where eaves and branches may hide or show the
// ground. A candidate without roof points, or without ground below, gets none.
std::vector<MatchedPoints> CountMatched(std::span<const Candidate> candidates, std::span<const Eigen::Vector3d> points, const PointCloud& cloud,
                                        const GroundGrid& ground, base::ThreadPool& threads);

// The crown of a tree falls into many small planes, whatever its colour.
struct PlaneSizes {
  double outline_m2 = 0.0;
  double mean_m2 = 0.0;                         // of the plane at a random place of the roof: sum a^2 / sum a, areas seen from above
  double largest = 0.0, two = 0.0, four = 0.0;  // shares of the outline: of the largest plane, the two and the four largest
};
PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2);

// The patch of a round crown that is planar within the tolerance of planes, which follows the GSD, has an area in proportion to radius and tolerance;
// so limits of areas follow the GSD too. colours_tell: vegetation of this survey can be told by its colour, so that a doubtful candidate is believed.
bool LooksLikeCrown(const PlaneSizes& sizes, double gsd_m, bool colours_tell);

}  // namespace skyquilt::buildings
