#include "buildings/geometry/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

template <typename Visit>
void ForEachRing(const Polygon& polygon, const Visit& visit) {
  visit(polygon.outer);
  for (const Ring& hole : polygon.holes) visit(hole);
}

template <typename Visit>
void ForEachEdge(const Polygon& polygon, const Visit& visit) {
  ForEachRing(polygon, [&](const Ring& ring) {
    for (size_t i = 0; i < ring.size(); ++i) visit(ring[i], ring[(i + 1) % ring.size()]);
  });
}

}  // namespace

Polygon Rectangle::Outline() const {
  const Eigen::Vector2d along = half.x() * axis, across = half.y() * Eigen::Vector2d(-axis.y(), axis.x());
  return {{centre - along - across, centre + along - across, centre + along + across, centre - along + across}, {}};
}

double Area(const Polygon& polygon) {
  double area = 0.0;
  ForEachRing(polygon, [&](const Ring& ring) { area += SignedArea(ring); });
  return area;
}

double Perimeter(const Polygon& polygon) {
  double length = 0.0;
  ForEachEdge(polygon, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { length += (b - a).norm(); });
  return length;
}

Eigen::Vector2d Centroid(const Polygon& polygon) {
  if (polygon.outer.empty()) return Eigen::Vector2d::Zero();
  // Relative to a vertex, so that places far from the origin lose no digits.
  const Eigen::Vector2d from = polygon.outer.front();
  double area = 0.0;
  Eigen::Vector2d moment = Eigen::Vector2d::Zero(), mean = Eigen::Vector2d::Zero();
  ForEachEdge(polygon, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    const double twice = Cross2(a - from, b - from);
    area += 0.5 * twice;
    moment += twice / 6.0 * (a + b - 2.0 * from);
  });
  const double size2 = Perimeter(polygon) * Perimeter(polygon);
  if (std::abs(area) > 1e-12 * size2) return from + moment / area;
  for (const Eigen::Vector2d& p : polygon.outer) mean += (p - from) / static_cast<double>(polygon.outer.size());
  return from + mean;
}

bool Contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool inside = false;
  ForEachRing(polygon, [&](const Ring& ring) { inside = inside != RingContains(ring, point); });
  return inside;
}

double DistanceToBorder(const Polygon& polygon, const Eigen::Vector2d& point) {
  double least = std::numeric_limits<double>::infinity();
  ForEachEdge(polygon, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { least = std::min(least, DistanceToSegment(point, a, b)); });
  return least;
}

}  // namespace skyquilt::buildings
