#include "surface/texture/tile_geometry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace skyquilt::surface {
namespace {

// Least area of a triangle relative to the square of its longest edge: below, its normal is rounding noise.
constexpr double kLeastShape = 1e-10;

struct HalfEdge {
  uint32_t low, high;
  uint32_t triangle;
  uint8_t side;
  bool forward;  // from the low to the high vertex
};

bool IsUsable(const Mesh& mesh, const Triangle& t) {
  for (const uint32_t vertex : t) {
    if (vertex >= mesh.position.size() || !mesh.position[vertex].allFinite()) return false;
  }
  return true;
}

std::vector<std::array<int32_t, 3>> FindNeighbors(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(triangles.size() * 3);
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (size_t side = 0; side < 3; ++side) {
      const uint32_t a = triangles[t][side];
      const uint32_t b = triangles[t][(side + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), static_cast<uint32_t>(t), static_cast<uint8_t>(side), a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
    return std::tie(a.low, a.high, a.triangle, a.side) < std::tie(b.low, b.high, b.triangle, b.side);
  });
  std::vector<std::array<int32_t, 3>> neighbor(triangles.size(), {-1, -1, -1});
  for (size_t first = 0; first < edges.size();) {
    size_t last = first + 1;
    while (last < edges.size() && edges[last].low == edges[first].low && edges[last].high == edges[first].high) ++last;
    const HalfEdge& a = edges[first];
    const HalfEdge& b = edges[last - 1];
    if (last - first == 2 && a.forward != b.forward && a.triangle != b.triangle) {
      neighbor[a.triangle][a.side] = static_cast<int32_t>(b.triangle);
      neighbor[b.triangle][b.side] = static_cast<int32_t>(a.triangle);
    }
    first = last;
  }
  return neighbor;
}

}  // namespace

Eigen::Vector3d TileGeometry::NormalAt(size_t t, double b1, double b2) const {
  const Triangle& corners = triangle[t];
  const Eigen::Vector3d sum = (1.0 - b1 - b2) * vertex_normal[corners[0]] + b1 * vertex_normal[corners[1]] + b2 * vertex_normal[corners[2]];
  const double length = sum.norm();
  return length > 1e-3 ? Eigen::Vector3d(sum / length) : face_normal[t];
}

TileGeometry GeometryOf(const Mesh& mesh) {
  TileGeometry geometry;
  geometry.mesh = &mesh;
  std::vector<Eigen::Vector3d> sum(mesh.position.size(), Eigen::Vector3d::Zero());
  for (const Triangle& t : mesh.triangle) {
    if (!IsUsable(mesh, t)) continue;
    const Eigen::Vector3d ab = mesh.position[t[1]] - mesh.position[t[0]];
    const Eigen::Vector3d ac = mesh.position[t[2]] - mesh.position[t[0]];
    const Eigen::Vector3d cross = ab.cross(ac);
    const double twice_area = cross.norm();
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(twice_area > kLeastShape * longest) || !std::isfinite(twice_area)) continue;
    if (geometry.triangle.empty()) geometry.min_enu = geometry.max_enu = mesh.position[t[0]];
    for (const uint32_t vertex : t) {
      sum[vertex] += cross;
      geometry.min_enu = geometry.min_enu.cwiseMin(mesh.position[vertex]);
      geometry.max_enu = geometry.max_enu.cwiseMax(mesh.position[vertex]);
    }
    geometry.triangle.push_back(t);
    geometry.face_normal.push_back(cross / twice_area);
    geometry.area.push_back(0.5 * twice_area);
  }
  geometry.vertex_normal.reserve(sum.size());
  for (const Eigen::Vector3d& normal : sum) {
    const double length = normal.norm();
    geometry.vertex_normal.push_back(length > 0.0 && std::isfinite(length) ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::UnitZ());
  }
  geometry.neighbor = FindNeighbors(geometry.triangle);
  return geometry;
}

}  // namespace skyquilt::surface
