// Closed chains of points in the plane, the borders of polygons.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::buildings {

using Ring = std::vector<Eigen::Vector2d>;

inline double Cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}
// Square metres; negative when the ring is clockwise.
double SignedArea(std::span<const Eigen::Vector2d> ring);
// By the number of edges to the east of the point. Points on the ring may count either way.
bool RingContains(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point);
double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b);
// Cuts a ring that passes vertices more than once into rings that pass each vertex once. Pieces of fewer than three vertices are left out.
std::vector<std::vector<uint32_t>> SplitAtRepeats(std::span<const uint32_t> ring);

}  // namespace skyquilt::buildings
