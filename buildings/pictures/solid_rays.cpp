#include "buildings/pictures/solid_rays.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::buildings {

SolidRays::SolidRays(const Solid& solid) {
  const SolidTriangles triangles = Triangulate(solid);
  for (size_t i = 0; i < triangles.triangle.size(); ++i) {
    const auto& [a, b, c] = triangles.triangle[i];
    triangles_.push_back(
        {solid.vertex[a], solid.vertex[b] - solid.vertex[a], solid.vertex[c] - solid.vertex[a], static_cast<int>(triangles.face[i])});
  }
}

// Moeller and Trumbore 1997, without a test of the side.
double SolidRays::FirstHit(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, int but, int and_but) const {
  double first = std::numeric_limits<double>::infinity();
  for (const Triangle& triangle : triangles_) {
    if (triangle.face == but || triangle.face == and_but) continue;
    const Eigen::Vector3d p = direction.cross(triangle.ac);
    const double determinant = triangle.ab.dot(p);
    if (std::abs(determinant) < 1e-12) continue;
    const Eigen::Vector3d from = origin - triangle.a;
    const double u = from.dot(p) / determinant;
    if (u < 0.0 || u > 1.0) continue;
    const Eigen::Vector3d q = from.cross(triangle.ab);
    const double v = direction.dot(q) / determinant;
    if (v < 0.0 || u + v > 1.0) continue;
    const double t = triangle.ac.dot(q) / determinant;
    if (t > 0.0) first = std::min(first, t);
  }
  return first;
}

}  // namespace skyquilt::buildings
