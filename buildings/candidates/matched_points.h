// What points that were matched in photos say about a candidate: a second opinion that does not come from the field.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "buildings/candidates/find_candidates.h"
#include "buildings/points/surface_points.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

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

}  // namespace skyquilt::buildings
