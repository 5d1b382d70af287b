// What a traced ray hit, and the optical properties of the surface there. Colours are linear.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

struct Hit {
  Eigen::Vector3f position;   // ENU metres
  Eigen::Vector3f normal;     // shading normal, unit, towards the viewer
  Eigen::Vector3f direction;  // of the ray, unit
  float footprint_m = 0.1F;   // width of a pixel at the hit, perpendicular to the ray
  Tag tag;
};

struct Surface {
  Eigen::Vector3f albedo = Eigen::Vector3f::Constant(0.3F);
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float mirror = 0.0F;        // reflectance at normal incidence of a clear layer on top; 0: none
  float mirror_share = 1.0F;  // of the surface that has this layer, 0..1
  Eigen::Vector3f mirror_normal = Eigen::Vector3f::UnitZ();
};

// Width of a pixel on the surface, metres: larger when seen at an angle. Limited, so that grazing views keep some texture.
inline float SurfaceFootprint(const Hit& hit) {
  return hit.footprint_m / std::max(std::abs(hit.normal.dot(hit.direction)), 0.35F);
}

}  // namespace skyquilt::simulate
