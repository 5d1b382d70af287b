// The points of roof, walls and ground around a building seen from above.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "buildings/buildings_options.h"
#include "buildings/candidates/find_candidates.h"
#include "buildings/candidates/piece_kind.h"
#include "buildings/candidates/plan_index.h"
#include "buildings/candidates/roof_outlines.h"

namespace skyquilt::buildings {

// Everything that the points are chosen from.
struct Surface {
  const PointCloud& cloud;
  const GroundGrid& ground;
  const PlanIndex& plan;
  const BuildingsOptions& options;
  double gsd_m;
};

// Candidate without outline; its planes are the pieces, cut to the points of its roof. wall_distance_m: of each wall point from the outline.
struct Gathered {
  Candidate candidate;
  std::vector<float> wall_distance_m;
};
Gathered GatherPoints(const RoofArea& area, std::span<const PlanePiece> pieces, const Surface& surface);

// A wall between two buildings belongs to the nearer one; at equal distances to the first.
void ShareWalls(std::vector<Gathered>* all);

}  // namespace skyquilt::buildings
