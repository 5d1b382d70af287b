// Least rectangles around points.
#include <algorithm>
#include <limits>

#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

// Counter-clockwise, without points on its edges (Andrew 1979).
Ring ConvexHull(std::span<const Eigen::Vector2d> points) {
  Ring sorted(points.begin(), points.end());
  const auto before = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); };
  std::sort(sorted.begin(), sorted.end(), before);
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  Ring hull;
  const auto add = [&](const Eigen::Vector2d& p, size_t fixed) {
    while (hull.size() > fixed && Cross2(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0.0) hull.pop_back();
    hull.push_back(p);
  };
  for (const Eigen::Vector2d& p : sorted) add(p, 1);
  const size_t lower = hull.size();
  for (size_t i = sorted.size() - 1; i-- > 0;) add(sorted[i], lower);
  hull.pop_back();
  return hull;
}

}  // namespace

Rectangle RectangleAlong(std::span<const Eigen::Vector2d> points, const Eigen::Vector2d& axis) {
  const Eigen::Vector2d along = axis.normalized(), across(-along.y(), along.x());
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector2d least(kInfinity, kInfinity), most = -least;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d place(p.dot(along), p.dot(across));
    least = least.cwiseMin(place);
    most = most.cwiseMax(place);
  }
  const Eigen::Vector2d middle = 0.5 * (least + most);
  return {middle.x() * along + middle.y() * across, along, 0.5 * (most - least)};
}

Rectangle LeastAreaRectangle(std::span<const Eigen::Vector2d> points) {
  const Ring hull = ConvexHull(points);
  if (hull.size() == 1) return {hull.front(), Eigen::Vector2d::UnitX(), Eigen::Vector2d::Zero()};
  // The least rectangle has a side on an edge of the hull (Freeman and Shapira 1975).
  Rectangle best;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); ++i) {
    const Rectangle rectangle = RectangleAlong(hull, hull[(i + 1) % hull.size()] - hull[i]);
    const double area = rectangle.half.prod();
    // The margin keeps rounding from choosing between equal rectangles.
    if (area < least * (1.0 - 1e-12)) {
      least = area;
      best = rectangle;
    }
  }
  if (best.half.x() < best.half.y()) {
    best.axis = Eigen::Vector2d(-best.axis.y(), best.axis.x());
    std::swap(best.half.x(), best.half.y());
  }
  return best;
}

}  // namespace skyquilt::buildings
