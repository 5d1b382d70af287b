#include "evaluate/buildings/shared_areas.h"

#include <Eigen/Geometry>

namespace skyquilt::evaluate::buildings {
namespace {

Eigen::AlignedBox2d BoxOf(const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : polygon.outer) box.extend(point);
  return box;
}

bool AreNear(const Polygon& a, const Polygon& b) {
  return BoxOf(a).intersects(BoxOf(b));
}

std::vector<Polygon> NearTo(const Polygon& place, std::span<const Polygon> polygons) {
  std::vector<Polygon> near;
  for (const Polygon& polygon : polygons) {
    if (AreNear(place, polygon)) near.push_back(polygon);
  }
  return near;
}

}  // namespace

double TotalArea(std::span<const Polygon> disjoint) {
  double sum_m2 = 0.0;
  for (const Polygon& polygon : disjoint) sum_m2 += Area(polygon);
  return sum_m2;
}

double SharedArea(const Polygon& a, const Polygon& b) {
  return AreNear(a, b) ? TotalArea(Intersection(a, b)) : 0.0;
}

double CoveredArea(const Polygon& place, std::span<const Polygon> by) {
  double sum_m2 = 0.0;
  for (const Polygon& piece : Union(NearTo(place, by))) sum_m2 += SharedArea(place, piece);
  return sum_m2;
}

std::vector<Polygon> Without(const Polygon& polygon, std::span<const Polygon> taken) {
  const std::vector<Polygon> near = NearTo(polygon, taken);
  return near.empty() ? std::vector<Polygon>{polygon} : Difference(polygon, near);
}

}  // namespace skyquilt::evaluate::buildings
