// Which texels a triangle covers. Texel (x, y) is the square from (x, y) to (x + 1, y + 1), its centre at + 0.5.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace skyquilt::surface {

using TexelTriangle = std::array<Eigen::Vector2d, 3>;

// Twice the signed area of (a, b, p); exactly the negative of that of (b, a, p), so that neighbours agree about points on their edge.
inline double SideOf(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  const bool swapped = b.x() < a.x() || (b.x() == a.x() && b.y() < a.y());
  const Eigen::Vector2d& s = swapped ? b : a;
  const Eigen::Vector2d& t = swapped ? a : b;
  const double side = (t.x() - s.x()) * (p.y() - s.y()) - (t.y() - s.y()) * (p.x() - s.x());
  return swapped ? -side : side;
}

// Calls f(x, y, b1, b2) for all texels whose centre is inside; b1, b2: barycentric weights of the second and third corner. A centre on an edge
// belongs to one of the two triangles there (top-left rule), so that each centre of a surface without folds belongs to exactly one triangle.
template <typename F>
void ForEachCentreInside(const TexelTriangle& corners, const F& f) {
  const double area = SideOf(corners[0], corners[1], corners[2]);
  if (!(std::abs(area) > 0.0)) return;
  const bool flipped = area < 0.0;
  const Eigen::Vector2d& a = corners[0];
  const Eigen::Vector2d& b = corners[flipped ? 2 : 1];
  const Eigen::Vector2d& c = corners[flipped ? 1 : 2];
  const auto owns_edge = [](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    return to.y() < from.y() || (to.y() == from.y() && to.x() > from.x());
  };
  const bool own_bc = owns_edge(b, c);
  const bool own_ca = owns_edge(c, a);
  const bool own_ab = owns_edge(a, b);
  const int x_first = static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}) - 0.5));
  const int x_last = static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}) - 0.5));
  const int y_first = static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}) - 0.5));
  const int y_last = static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}) - 0.5));
  for (int y = y_first; y <= y_last; ++y) {
    for (int x = x_first; x <= x_last; ++x) {
      const Eigen::Vector2d p(x + 0.5, y + 0.5);
      const double wa = SideOf(b, c, p);
      if (wa < 0.0 || (wa == 0.0 && !own_bc)) continue;
      const double wb = SideOf(c, a, p);
      if (wb < 0.0 || (wb == 0.0 && !own_ca)) continue;
      const double wc = SideOf(a, b, p);
      if (wc < 0.0 || (wc == 0.0 && !own_ab)) continue;
      const double sum = wa + wb + wc;
      if (!(sum > 0.0)) continue;
      f(x, y, (flipped ? wc : wb) / sum, (flipped ? wb : wc) / sum);
    }
  }
}

// The point of a triangle that is nearest to p, which is not inside: its barycentric weights, and its distance squared.
struct NearestPoint {
  double b1 = 0.0, b2 = 0.0;
  double distance2 = 0.0;
};

inline NearestPoint NearestOnEdges(const TexelTriangle& corners, const Eigen::Vector2d& p) {
  NearestPoint best;
  for (size_t side = 0; side < 3; ++side) {
    const Eigen::Vector2d& a = corners[side];
    const Eigen::Vector2d edge = corners[(side + 1) % 3] - a;
    const double length2 = edge.squaredNorm();
    const double s = length2 > 0.0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
    const double distance2 = (a + s * edge - p).squaredNorm();
    if (side > 0 && !(distance2 < best.distance2)) continue;
    std::array<double, 3> weight{};
    weight[side] = 1.0 - s;
    weight[(side + 1) % 3] = s;
    best = {weight[1], weight[2], distance2};
  }
  return best;
}

// Calls f(x, y) for the texels near a triangle whose squares it may touch.
template <typename F>
void ForEachTexelNear(const TexelTriangle& corners, const F& f) {
  constexpr double kReach = 0.75;  // half the diagonal of a texel, and some more
  const double area = SideOf(corners[0], corners[1], corners[2]);
  const double sign = area < 0.0 ? -1.0 : 1.0;
  std::array<double, 3> slack{};  // of the signed area at a centre within reach of an edge
  for (size_t side = 0; side < 3; ++side) slack[side] = kReach * (corners[(side + 1) % 3] - corners[side]).norm();
  const auto bounds = std::minmax({corners[0].x(), corners[1].x(), corners[2].x()});
  const auto rows = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
  for (int y = static_cast<int>(std::floor(rows.first)); y <= static_cast<int>(std::floor(rows.second)); ++y) {
    for (int x = static_cast<int>(std::floor(bounds.first)); x <= static_cast<int>(std::floor(bounds.second)); ++x) {
      const Eigen::Vector2d p(x + 0.5, y + 0.5);
      bool near = true;
      for (size_t side = 0; side < 3 && near; ++side) near = sign * SideOf(corners[side], corners[(side + 1) % 3], p) >= -slack[side];
      if (near) f(x, y);
    }
  }
}

}  // namespace skyquilt::surface
