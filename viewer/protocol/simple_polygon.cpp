#include <cmath>

#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {
namespace {

constexpr double kSmallestShare = 1e-12;  // of the squared perimeter: less is a line

// Twice the signed area of the triangle.
double Turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d u = b - a, v = c - a;
  return u.x() * v.y() - u.y() * v.x();
}

// For a point on the line through a and b.
bool IsBetween(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& point) {
  return (point.array() >= a.array().min(b.array())).all() && (point.array() <= a.array().max(b.array())).all();
}

bool Meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const double c_side = Turn(a, b, c), d_side = Turn(a, b, d), a_side = Turn(c, d, a), b_side = Turn(c, d, b);
  if (((c_side > 0.0 && d_side < 0.0) || (c_side < 0.0 && d_side > 0.0)) && ((a_side > 0.0 && b_side < 0.0) || (a_side < 0.0 && b_side > 0.0))) {
    return true;
  }
  return (c_side == 0.0 && IsBetween(a, b, c)) || (d_side == 0.0 && IsBetween(a, b, d)) || (a_side == 0.0 && IsBetween(c, d, a)) ||
         (b_side == 0.0 && IsBetween(c, d, b));
}

// Consecutive edges of which the second goes back over the first.
bool FoldsBack(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return Turn(a, b, c) == 0.0 && (b - a).dot(c - b) <= 0.0;
}

}  // namespace

bool IsSimplePolygon(const std::vector<Eigen::Vector2d>& polygon) {
  const size_t n = polygon.size();
  if (n < 3) return false;
  double doubled_area = 0.0, perimeter = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % n];
    if (!a.allFinite() || a == b) return false;
    if (FoldsBack(a, b, polygon[(i + 2) % n])) return false;
    for (size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n != i && Meet(a, b, polygon[j], polygon[(j + 1) % n])) return false;
    }
    perimeter += (b - a).norm();
    // Seen from the first corner: coordinates may be large.
    doubled_area += Turn(polygon[0], a, b);
  }
  return 0.5 * std::abs(doubled_area) > kSmallestShare * perimeter * perimeter;
}

}  // namespace skyquilt::viewer
