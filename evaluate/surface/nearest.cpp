#include "evaluate/surface/nearest.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace skyquilt::evaluate::surface {
namespace {

constexpr uint32_t kLeafTriangles = 4;

Eigen::Vector3d NearestOnSegment(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = b - a;
  const double length2 = along.squaredNorm();
  return length2 > 0.0 ? Eigen::Vector3d(a + std::clamp(along.dot(p - a) / length2, 0.0, 1.0) * along) : a;
}

double SquaredDistanceToBox(const Eigen::Vector3d& p, const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const Eigen::Vector3d below = low.cast<double>() - p, above = p - high.cast<double>();
  return below.cwiseMax(above).cwiseMax(0.0).squaredNorm();
}

}  // namespace

Eigen::Vector3d NearestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const double area2 = normal.squaredNorm();
  if (area2 > 0.0) {
    // Above the inside of the triangle the foot of the perpendicular is nearest.
    const bool inside = normal.dot((b - a).cross(p - a)) >= 0.0 && normal.dot((c - b).cross(p - b)) >= 0.0 && normal.dot((a - c).cross(p - c)) >= 0.0;
    if (inside) return p - normal * (normal.dot(p - a) / area2);
  }
  Eigen::Vector3d nearest = NearestOnSegment(p, a, b);
  for (const Eigen::Vector3d& other : {NearestOnSegment(p, b, c), NearestOnSegment(p, c, a)}) {
    if ((other - p).squaredNorm() < (nearest - p).squaredNorm()) nearest = other;
  }
  return nearest;
}

NearestTriangles::NearestTriangles(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle)
    : position_(position.begin(), position.end()), triangle_(triangle.begin(), triangle.end()), order_(triangle.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  if (!order_.empty()) Build(0, static_cast<uint32_t>(order_.size()));
}

Eigen::Vector3f NearestTriangles::Middle(uint32_t triangle) const {
  const auto& corner = triangle_[triangle];
  return (position_[corner[0]] + position_[corner[1]] + position_[corner[2]]) / 3.0F;
}

void NearestTriangles::Build(uint32_t first, uint32_t last) {
  const size_t place = nodes_.size();
  Node node;
  node.low = Eigen::Vector3f::Constant(std::numeric_limits<float>::infinity());
  node.high = -node.low;
  Eigen::Vector3f middle_low = node.low, middle_high = node.high;
  for (uint32_t i = first; i < last; ++i) {
    for (const uint32_t corner : triangle_[order_[i]]) {
      node.low = node.low.cwiseMin(position_[corner]);
      node.high = node.high.cwiseMax(position_[corner]);
    }
    const Eigen::Vector3f middle = Middle(order_[i]);
    middle_low = middle_low.cwiseMin(middle);
    middle_high = middle_high.cwiseMax(middle);
  }
  node.first = first;
  node.count = last - first;
  nodes_.push_back(node);
  if (last - first <= kLeafTriangles) return;
  Eigen::Index axis = 0;
  (middle_high - middle_low).maxCoeff(&axis);
  // Halves of equal size keep the tree low, also where many triangles are in one place.
  const uint32_t half = first + (last - first) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + last, [&](uint32_t a, uint32_t b) {
    const float at_a = Middle(a)[axis], at_b = Middle(b)[axis];
    return at_a < at_b || (at_a == at_b && a < b);
  });
  nodes_[place].count = 0;
  Build(first, half);
  nodes_[place].first = static_cast<uint32_t>(nodes_.size());
  Build(half, last);
}

std::optional<NearestTriangles::Found> NearestTriangles::Nearest(const Eigen::Vector3d& point, double limit_m) const {
  std::optional<Found> found;
  if (nodes_.empty() || !point.allFinite()) return found;
  double best2 = limit_m * limit_m;
  struct Open {
    uint32_t node;
    double distance2;
  };
  // Each level adds one entry, and a tree of 2^32 triangles has at most 32 levels.
  std::array<Open, 72> stack;
  size_t n_open = 0;
  stack[n_open++] = {0, SquaredDistanceToBox(point, nodes_[0].low, nodes_[0].high)};
  while (n_open > 0) {
    const Open open = stack[--n_open];
    if (open.distance2 > best2) continue;
    const Node& node = nodes_[open.node];
    if (node.count > 0) {
      for (uint32_t i = node.first; i < node.first + node.count; ++i) {
        const auto& corner = triangle_[order_[i]];
        const Eigen::Vector3d nearest =
            NearestOnTriangle(point, position_[corner[0]].cast<double>(), position_[corner[1]].cast<double>(), position_[corner[2]].cast<double>());
        const double distance2 = (nearest - point).squaredNorm();
        if (!(distance2 <= best2) || (found && distance2 == best2)) continue;
        best2 = distance2;
        found = Found{std::sqrt(distance2), nearest, order_[i]};
      }
      continue;
    }
    const std::array<uint32_t, 2> child = {open.node + 1, node.first};
    std::array<Open, 2> next;
    for (size_t i = 0; i < 2; ++i) next[i] = {child[i], SquaredDistanceToBox(point, nodes_[child[i]].low, nodes_[child[i]].high)};
    if (next[0].distance2 < next[1].distance2) std::swap(next[0], next[1]);  // the nearer one is taken next
    for (const Open& one : next) {
      if (one.distance2 <= best2) stack[n_open++] = one;
    }
  }
  return found;
}

}  // namespace skyquilt::evaluate::surface
