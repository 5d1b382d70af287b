// Segments cut where they meet, so that they have nothing in common but ends.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "buildings/geometry/planar_map.h"

namespace skyquilt::buildings {

struct SnappedSegments {
  std::vector<Eigen::Vector2d> vertex;            // farther apart than the tolerance
  std::set<std::pair<uint32_t, uint32_t>> edges;  // smaller vertex first
};
// As PlanarMap says.
SnappedSegments Snap(std::span<const Segment> segments, double snap_m);

}  // namespace skyquilt::buildings
