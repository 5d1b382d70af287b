// Faces of a shell that meet where they should not, by their triangles.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "buildings/solids/solid_checks.h"

namespace skyquilt::buildings {
namespace {

constexpr double kTouch = 1e-7;  // metres within which a point is in a plane or on a line

struct PlacedTriangle {
  std::array<uint32_t, 3> vertex;
  std::array<Eigen::Vector3d, 3> at;
  Eigen::Vector3d normal;  // length 1; zero without area
  Eigen::AlignedBox3d box;
  uint32_t face;

  bool Has(uint32_t v) const { return std::find(vertex.begin(), vertex.end(), v) != vertex.end(); }
};

// Whether a point of the triangle's plane lies in the triangle or on its border.
bool Covers(const PlacedTriangle& t, const Eigen::Vector3d& p) {
  for (size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d along = t.at[(k + 1) % 3] - t.at[k];
    if (t.normal.dot(along.cross(p - t.at[k])) < -kTouch * along.norm()) return false;
  }
  return true;
}

bool SegmentMeetsInPlane(const PlacedTriangle& t, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  if (Covers(t, a) || Covers(t, b)) return true;
  const Eigen::Vector3d along = b - a;
  for (size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &c = t.at[k], &d = t.at[(k + 1) % 3];
    const double of_c = t.normal.dot(along.cross(c - a)), of_d = t.normal.dot(along.cross(d - a));
    const double of_a = t.normal.dot((d - c).cross(a - c)), of_b = t.normal.dot((d - c).cross(b - c));
    if ((of_c > 0.0) != (of_d > 0.0) && (of_a > 0.0) != (of_b > 0.0)) return true;
  }
  return false;
}

// Whether a segment meets the triangle, borders included.
bool SegmentMeets(const PlacedTriangle& t, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double over_a = t.normal.dot(a - t.at[0]), over_b = t.normal.dot(b - t.at[0]);
  if (std::abs(over_a) <= kTouch && std::abs(over_b) <= kTouch) return SegmentMeetsInPlane(t, a, b);
  if (std::min(over_a, over_b) > kTouch || std::max(over_a, over_b) < -kTouch) return false;
  const double along = std::clamp(over_a / (over_a - over_b), 0.0, 1.0);
  return Covers(t, a + along * (b - a));
}

// Triangles of one edge overlap when they are folded onto each other.
bool Folded(const PlacedTriangle& s, const PlacedTriangle& t, const std::array<uint32_t, 2>& edge) {
  const auto other = [&](const PlacedTriangle& triangle) {
    size_t k = 0;
    while (triangle.vertex[k] == edge[0] || triangle.vertex[k] == edge[1]) ++k;
    return triangle.at[k];
  };
  const Eigen::Vector3d a = other(s), b = other(t);
  if (std::abs(s.normal.dot(b - s.at[0])) > kTouch || std::abs(t.normal.dot(a - t.at[0])) > kTouch) return false;
  size_t k = 0;
  while (s.vertex[k] != edge[0]) ++k;
  const Eigen::Vector3d from = s.at[k];
  k = 0;
  while (s.vertex[k] != edge[1]) ++k;
  const Eigen::Vector3d along = (s.at[k] - from).normalized();
  const Eigen::Vector3d to_a = (a - from) - along.dot(a - from) * along, to_b = (b - from) - along.dot(b - from) * along;
  return to_a.dot(to_b) > 0.0;
}

// Whether edges of one triangle meet the other: all of them, or, with a vertex in common, the edge opposite to it.
bool EdgesMeetTriangle(const PlacedTriangle& s, const PlacedTriangle& t) {
  for (size_t k = 0; k < 3; ++k) {
    const size_t next = (k + 1) % 3;
    if (t.Has(s.vertex[k]) || t.Has(s.vertex[next])) continue;
    if (SegmentMeets(t, s.at[k], s.at[next])) return true;
  }
  return false;
}

bool TrianglesMeet(const PlacedTriangle& s, const PlacedTriangle& t) {
  std::vector<uint32_t> shared;
  for (const uint32_t v : s.vertex) {
    if (t.Has(v)) shared.push_back(v);
  }
  if (shared.size() == 3) return true;
  if (shared.size() == 2) return Folded(s, t, {shared[0], shared[1]});
  return EdgesMeetTriangle(s, t) || EdgesMeetTriangle(t, s);
}

}  // namespace

std::vector<std::pair<uint32_t, uint32_t>> CrossingFaces(const Solid& solid, const SolidTriangles& triangles) {
  std::vector<PlacedTriangle> placed;
  for (size_t i = 0; i < triangles.triangle.size(); ++i) {
    PlacedTriangle t;
    t.vertex = triangles.triangle[i];
    for (size_t k = 0; k < 3; ++k) {
      t.at[k] = solid.vertex[t.vertex[k]] - solid.vertex.front();
      t.box.extend(t.at[k]);
    }
    t.box = Eigen::AlignedBox3d(t.box.min().array() - kTouch, t.box.max().array() + kTouch);
    t.normal = (t.at[1] - t.at[0]).cross(t.at[2] - t.at[0]);
    if (!(t.normal.norm() > 0.0)) continue;
    t.normal.normalize();
    t.face = triangles.face[i];
    placed.push_back(t);
  }
  std::sort(placed.begin(), placed.end(), [](const PlacedTriangle& s, const PlacedTriangle& t) { return s.box.min().x() < t.box.min().x(); });
  std::set<std::pair<uint32_t, uint32_t>> crossing;
  for (size_t i = 0; i < placed.size(); ++i) {
    for (size_t j = i + 1; j < placed.size() && placed[j].box.min().x() <= placed[i].box.max().x(); ++j) {
      if (placed[i].face == placed[j].face || !placed[i].box.intersects(placed[j].box)) continue;
      if (TrianglesMeet(placed[i], placed[j])) crossing.insert(std::minmax(placed[i].face, placed[j].face));
    }
  }
  return {crossing.begin(), crossing.end()};
}

}  // namespace skyquilt::buildings
