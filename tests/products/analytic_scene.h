// A scene with known answers: a level plane with one box-shaped house, both opaque, in ENU.
#pragma once

#include <cmath>
#include <limits>

#include "products/ray_caster.h"

namespace skyquilt::products {

struct AnalyticScene {
  double ground_z = 5.0;
  double roof_z = 25.0;
  Eigen::Vector2d house_min{10.0, -20.0};
  Eigen::Vector2d house_max{40.0, 10.0};
  double open_west = -1e9;  // no ground west of this x

  bool InHouse(double x, double y) const { return x >= house_min.x() && x <= house_max.x() && y >= house_min.y() && y <= house_max.y(); }
  double SurfaceZ(double x, double y) const { return InHouse(x, y) ? roof_z : ground_z; }

  // Distance along the ray to the first surface; infinity for none.
  double Distance(const render::Ray& ray) const {
    const Eigen::Vector3d& o = ray.origin_enu;
    const Eigen::Vector3d& d = ray.direction_enu;
    double best = std::numeric_limits<double>::infinity();
    if (d.z() < 0.0) {
      const double t = (ground_z - o.z()) / d.z();
      if (t >= 0.0 && o.x() + t * d.x() >= open_west) best = t;
    }
    const Eigen::Array3d low(house_min.x(), house_min.y(), ground_z);
    const Eigen::Array3d high(house_max.x(), house_max.y(), roof_z);
    const Eigen::Array3d t0 = (low - o.array()) / d.array();
    const Eigen::Array3d t1 = (high - o.array()) / d.array();
    const double t_near = t0.min(t1).maxCoeff();
    const double t_far = t0.max(t1).minCoeff();
    if (t_near <= t_far && t_near >= 0.0) best = std::min(best, t_near);
    return best;
  }

  // Ground: red east of the origin, green west of it. House: blue.
  RayCaster Caster() const {
    return [*this](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      for (size_t i = 0; i < rays.size(); ++i) {
        const double t = Distance(rays[i]);
        if (!(t >= rays[i].t_near && t <= rays[i].t_far)) {
          out[i].depth = out[i].depth_median = std::numeric_limits<float>::quiet_NaN();
          continue;
        }
        const Eigen::Vector3d x = rays[i].origin_enu + t * rays[i].direction_enu;
        out[i].opacity = 1.0F;
        out[i].depth = out[i].depth_median = out[i].depth_front = out[i].depth_back = static_cast<float>(t);
        const bool house = x.z() > ground_z + 1e-6;
        out[i].rgb_srgb[0] = !house && x.x() >= 0.0 ? 1.0F : 0.0F;
        out[i].rgb_srgb[1] = !house && x.x() < 0.0 ? 1.0F : 0.0F;
        out[i].rgb_srgb[2] = house ? 1.0F : 0.0F;
      }
    };
  }

  // 120 x 100 m about the origin, in two blocks side by side.
  scene::SceneInfo Info(const geo::Geodetic& origin, bool georeferenced) const {
    scene::SceneInfo info;
    info.origin = origin;
    info.georeferenced = georeferenced;
    info.gsd_m = 0.46;
    for (int i = 0; i < 2; ++i) {
      scene::SceneBlock block;
      block.name = "r0c" + std::to_string(i);
      block.min_enu = {-60.0 + 60.0 * i, -50.0, ground_z - 2.0};
      block.max_enu = {60.0 * i, 50.0, roof_z + 2.0};
      block.margin_m = 3.0;
      info.blocks.push_back(block);
    }
    info.min_enu = info.blocks[0].min_enu;
    info.max_enu = info.blocks[1].max_enu;
    return info;
  }
};

}  // namespace skyquilt::products
