#include "buildings/classes/solid_edges.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace skyquilt::buildings {
namespace {

using Ring = std::vector<uint32_t>;

Eigen::Vector3d AreaVector(const Solid& solid, const Ring& ring) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < ring.size(); ++i) {
    const Eigen::Vector3d& first = solid.vertex[ring[0]];
    sum += (solid.vertex[ring[i]] - first).cross(solid.vertex[ring[i + 1]] - first);
  }
  return 0.5 * sum;
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Eigen::Vector3d NormalOf(const Solid& solid, const Face& face) {
  Eigen::Vector3d area = AreaVector(solid, face.outer);
  for (const Ring& hole : face.holes) area += AreaVector(solid, hole);
  const double length = area.norm();
  if (!(length > 0.0)) return Eigen::Vector3d::Zero();
  return area / length;
}

std::vector<SolidEdge> EdgesOf(const Solid& solid) {
  std::vector<Eigen::Vector3d> normal;
  std::vector<SolidEdge> edges;
  std::map<std::pair<uint32_t, uint32_t>, std::vector<size_t>> waiting;  // edges without other face, by their direction
  const auto add = [&](const Ring& ring, int face) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t from = ring[i], to = ring[(i + 1) % ring.size()];
      if (const auto partner = waiting.find({to, from}); partner != waiting.end() && !partner->second.empty()) {
        SolidEdge& edge = edges[partner->second.front()];
        partner->second.erase(partner->second.begin());
        const Eigen::Vector3d &a = normal[static_cast<size_t>(edge.face)], &b = normal[static_cast<size_t>(face)];
        edge.other = face;
        edge.angle_rad = AngleBetween(a, b);
        edge.convex = a.cross(b).dot(solid.vertex[edge.to] - solid.vertex[edge.from]) >= 0.0;
        continue;
      }
      waiting[{from, to}].push_back(edges.size());
      edges.push_back({.from = from, .to = to, .face = face, .angle_rad = std::numbers::pi});
    }
  };
  for (size_t i = 0; i < solid.face.size(); ++i) {
    const Face& face = solid.face[i];
    normal.push_back(NormalOf(solid, face));
    add(face.outer, static_cast<int>(i));
    for (const Ring& hole : face.holes) add(hole, static_cast<int>(i));
  }
  return edges;
}

}  // namespace skyquilt::buildings
