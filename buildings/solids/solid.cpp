#include "buildings/solids/solid.h"

#include <Eigen/Geometry>

#include "buildings/solids/face_plane.h"

namespace skyquilt::buildings {

double Volume(const Solid& solid) {
  if (solid.vertex.empty()) return 0.0;
  // Tetrahedra from one vertex keep the digits of solids far from the origin.
  const Eigen::Vector3d& from = solid.vertex.front();
  double volume = 0.0;
  const auto add = [&](const std::vector<uint32_t>& ring) {
    for (size_t i = 1; i + 1 < ring.size(); ++i) {
      const Eigen::Vector3d a = solid.vertex[ring[0]] - from, b = solid.vertex[ring[i]] - from, c = solid.vertex[ring[i + 1]] - from;
      volume += a.dot(b.cross(c)) / 6.0;
    }
  };
  for (const Face& face : solid.face) {
    add(face.outer);
    for (const std::vector<uint32_t>& hole : face.holes) add(hole);
  }
  return volume;
}

double Area(const Solid& solid, FaceKind kind) {
  double area = 0.0;
  for (const Face& face : solid.face) {
    if (face.kind == kind) area += AreaVector(solid, face).norm();
  }
  return area;
}

}  // namespace skyquilt::buildings
