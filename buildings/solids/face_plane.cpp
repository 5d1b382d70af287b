#include "buildings/solids/face_plane.h"

#include <Eigen/Geometry>
#include <cmath>

namespace skyquilt::buildings {

Eigen::Vector3d AreaVector(const Solid& solid, std::span<const uint32_t> ring) {
  Eigen::Vector3d twice = Eigen::Vector3d::Zero();
  for (size_t i = 1; i + 1 < ring.size(); ++i) {
    const Eigen::Vector3d& from = solid.vertex[ring[0]];
    twice += (solid.vertex[ring[i]] - from).cross(solid.vertex[ring[i + 1]] - from);
  }
  return 0.5 * twice;
}

Eigen::Vector3d AreaVector(const Solid& solid, const Face& face) {
  Eigen::Vector3d area = AreaVector(solid, face.outer);
  for (const std::vector<uint32_t>& hole : face.holes) area += AreaVector(solid, hole);
  return area;
}

FacePlane PlaneOf(const Solid& solid, const Face& face) {
  FacePlane plane;
  size_t n = face.outer.size();
  for (const std::vector<uint32_t>& hole : face.holes) n += hole.size();
  const auto add = [&](const std::vector<uint32_t>& ring) {
    for (const uint32_t v : ring) plane.middle += solid.vertex[v] / static_cast<double>(n);
  };
  add(face.outer);
  for (const std::vector<uint32_t>& hole : face.holes) add(hole);
  const Eigen::Vector3d area = AreaVector(solid, face.outer);
  if (!(area.norm() > 0.0)) return plane;
  plane.normal = area.normalized();
  // Upright faces keep y upright, level ones x to the east.
  plane.x =
      std::abs(plane.normal.z()) < 0.9 ? Eigen::Vector3d::UnitZ().cross(plane.normal).eval() : Eigen::Vector3d::UnitY().cross(plane.normal).eval();
  plane.x.normalize();
  plane.y = plane.normal.cross(plane.x);
  return plane;
}

}  // namespace skyquilt::buildings
