// Vector operations on triangles, without the large Geometry header of Eigen.
#pragma once

#include <Eigen/Core>

namespace skyquilt::surface {

inline Eigen::Vector3d Cross(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(), a.x() * b.y() - a.y() * b.x()};
}
// Normal of a counter-clockwise triangle, as long as twice its area.
inline Eigen::Vector3d DoubleAreaNormal(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return Cross(b - a, c - a);
}
// Twice the signed area of a triangle seen from above: positive when it is counter-clockwise.
inline double DoubleAreaFromAbove(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace skyquilt::surface
