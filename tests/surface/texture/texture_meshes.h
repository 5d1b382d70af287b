// Meshes, views and analytic fields for tests of the texture.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "core/base/random.h"
#include "surface/surface_input.h"
#include "surface/texture/bake_tile.h"

namespace skyquilt::surface::testing {

inline void AddVertex(Mesh* mesh, const Eigen::Vector3d& x) {
  mesh->key.push_back(mesh->position.size());
  mesh->position.push_back(x);
  mesh->views.push_back(7);
  mesh->filled.push_back(0);
}

// z = height(x, y) over [0, n * step]^2, two triangles per cell, seen from above.
inline Mesh HeightField(int n, double step, const std::function<double(double, double)>& height) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) AddVertex(&mesh, {x * step, y * step, height(x * step, y * step)});
  }
  const auto at = [n](int x, int y) { return static_cast<uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      mesh.triangle.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.triangle.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  return mesh;
}

// A closed box of twelve triangles, turned about its vertical axis through the origin.
inline Mesh Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double turn = 0.0) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d x((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(), (i & 4) != 0 ? high.z() : low.z());
    AddVertex(&mesh, {std::cos(turn) * x.x() - std::sin(turn) * x.y(), std::sin(turn) * x.x() + std::cos(turn) * x.y(), x.z()});
  }
  const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}};
  for (const auto& q : quads) {
    mesh.triangle.push_back({q[0], q[1], q[2]});
    mesh.triangle.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

inline void Append(Mesh* mesh, const Mesh& more) {
  const auto first = static_cast<uint32_t>(mesh->position.size());
  for (const Eigen::Vector3d& x : more.position) AddVertex(mesh, x);
  for (const Triangle& t : more.triangle) mesh->triangle.push_back({t[0] + first, t[1] + first, t[2] + first});
}

// Rough ground with a box on it: facades, overhangs where the box reaches into the ground, and many small pieces.
inline Mesh RandomTown(uint64_t seed, double roughness) {
  base::Random random(seed);
  std::vector<double> noise(64);
  for (double& value : noise) value = random.Uniform(-1.0, 1.0);
  Mesh mesh = HeightField(12, 0.5, [&](double x, double y) {
    const auto i = static_cast<size_t>(std::lround(x * 14.0) + std::lround(y * 26.0)) % noise.size();
    return roughness * noise[i] + 0.1 * x;
  });
  const double top = random.Uniform(1.0, 4.0);
  Append(&mesh, Box({1.0, 1.5, -0.5}, {3.0, 4.0, top}, random.Uniform(0.0, 1.5)));
  return mesh;
}

// A pinhole camera at a place, looking along a direction.
inline ViewPose PoseAt(const Eigen::Vector3d& centre, const Eigen::Vector3d& forward, int size, double focal_px, int photo) {
  ViewPose pose;
  pose.photo = photo;
  pose.width = pose.height = size;
  pose.focal_px = focal_px;
  pose.cx = pose.cy = 0.5 * size;
  const Eigen::Vector3d z = forward.normalized();
  const Eigen::Vector3d side = std::abs(z.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d y = z.cross(side).normalized();
  Eigen::Matrix3d rotation;
  rotation.row(0) = y.cross(z);
  rotation.row(1) = y;
  rotation.row(2) = z;
  pose.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
  pose.cam_from_enu.translation = -(pose.cam_from_enu.rotation * centre);
  return pose;
}

// First distance along a ray to a surface; NaN where it meets none.
using Surface = std::function<double(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

inline double PlaneAtZero(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const double t = -origin.z() / direction.z();
  return t > 0.0 ? t : std::nan("");
}

inline Surface BoxSurface(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return [low, high](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
    double enter = -1e30;
    double leave = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (low[axis] - origin[axis]) / direction[axis];
      const double b = (high[axis] - origin[axis]) / direction[axis];
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    return enter <= leave && enter > 0.0 ? enter : std::nan("");
  };
}

struct FilledView {
  ViewPose pose;
  std::vector<float> depth_m;
  std::vector<uint8_t> cosine;
  DepthView Get() const { return {pose, depth_m, cosine}; }
};

inline FilledView ViewOf(const ViewPose& pose, const Surface& surface) {
  FilledView view;
  view.pose = pose;
  for (int y = 0; y < pose.height; ++y) {
    for (int x = 0; x < pose.width; ++x) view.depth_m.push_back(static_cast<float>(surface(pose.Centre(), pose.DirectionAt(x + 0.5, y + 0.5))));
  }
  view.cosine.assign(view.depth_m.size(), 255);
  return view;
}

using ColorAt = std::function<Eigen::Vector3f(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& direction)>;

// A field with an opaque surface; half of the opacity is given, so that colours must be divided by it.
inline RayCaster FieldOf(const Surface& surface, const ColorAt& color) {
  return [surface, color](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    for (size_t i = 0; i < rays.size(); ++i) {
      const render::Ray& ray = rays[i];
      const double t = surface(ray.origin_enu, ray.direction_enu);
      out[i] = {};
      if (!(t >= ray.t_near && t <= ray.t_far)) continue;
      const Eigen::Vector3f rgb = color(ray.origin_enu + t * ray.direction_enu, ray.direction_enu);
      out[i].opacity = 0.5F;
      for (int channel = 0; channel < 3; ++channel) out[i].rgb_srgb[channel] = 0.5F * rgb[channel];
    }
  };
}

}  // namespace skyquilt::surface::testing
