// Flat ground at z = 0 with a house on it, whose depths are known exactly, and surveys of it.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "core/base/errors.h"
#include "core/geo/ray_box.h"
#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

struct AnalyticScene {
  Eigen::Vector3d house_min{-5.0, -5.0, 0.0}, house_max{5.0, 5.0, 8.0};
  bool has_house = true;
  // Changes the result of a ray that hits something at this place.
  std::function<void(const Eigen::Vector3d& x_in_enu, render::RayColor& color)> change;
  int64_t rays = 0;                                         // cast so far
  int64_t rays_left = std::numeric_limits<int64_t>::max();  // fewer: the caster is interrupted

  double Depth(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    double depth = direction.z() < 0.0 ? -origin.z() / direction.z() : std::numeric_limits<double>::infinity();
    const geo::Interval house = geo::RayBox(origin, direction, house_min, house_max);
    if (has_house && !house.Empty()) depth = std::min(depth, house.t_near);
    return depth;
  }

  RayCaster Caster() {
    return [this](std::span<const render::Ray> from, std::span<render::RayColor> to) {
      rays_left -= static_cast<int64_t>(from.size());
      if (rays_left < 0) throw base::Interrupted();
      rays += static_cast<int64_t>(from.size());
      for (size_t i = 0; i < from.size(); ++i) {
        const double depth = Depth(from[i].origin_enu, from[i].direction_enu);
        const float nan = std::numeric_limits<float>::quiet_NaN();
        to[i] = {.opacity = 0.0F, .depth = nan, .depth_median = nan, .depth_front = nan, .depth_back = nan};
        if (!(depth >= from[i].t_near && depth <= from[i].t_far)) continue;
        const auto value = static_cast<float>(depth);
        to[i] = {.opacity = 1.0F, .depth = value, .depth_median = value, .depth_front = value - 0.1F, .depth_back = value + 0.1F};
        if (change) change(from[i].origin_enu + depth * from[i].direction_enu, to[i]);
      }
    };
  }
};

// Looks straight down with north up.
inline geo::Rigid3d LookingDown(const Eigen::Vector3d& centre) {
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  pose.translation = -(pose.rotation * centre);
  return pose;
}

// Looks along the horizon with the sky up, so many degrees east of north.
inline geo::Rigid3d LookingLevel(const Eigen::Vector3d& centre, double heading_deg) {
  const double heading = heading_deg * std::numbers::pi / 180.0;
  Eigen::Matrix3d rotation;
  rotation << std::cos(heading), -std::sin(heading), 0.0, 0.0, 0.0, -1.0, std::sin(heading), std::cos(heading), 0.0;
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(rotation);
  pose.translation = -(pose.rotation * centre);
  return pose;
}

inline camera::Camera PinholeCamera(int width, int height, double focal) {
  return {camera::CameraModel::kPinhole, width, height, {focal, focal, 0.5 * width, 0.5 * height}};
}

// A survey without photos, 60 m above the ground, with pixels of 0.3 m and voxels of 0.45 m.
struct AnalyticSurvey {
  static constexpr double kAgl = 60.0, kVoxel = 0.45;
  AnalyticScene scene;
  survey::Survey survey;
  scene::SceneInfo info;
  SurfaceInput input;

  explicit AnalyticSurvey(const std::filesystem::path& work_folder) {
    survey.cameras.push_back(PinholeCamera(200, 150, 200.0));
    info.min_enu = {-500.0, -500.0, -2.0};
    info.max_enu = {500.0, 500.0, 30.0};
    info.gsd_m = 0.3;
    input.info = &info;
    input.survey = &survey;
    input.caster = scene.Caster();
    input.work_folder = work_folder;
  }
  AnalyticSurvey(const AnalyticSurvey&) = delete;
  AnalyticSurvey& operator=(const AnalyticSurvey&) = delete;

  void AddPhoto(double x, double y, bool is_test = false) {
    survey::Photo photo;
    photo.name = std::to_string(survey.photos.size()) + ".jpg";
    photo.cam_from_enu = LookingDown({x, y, kAgl});
    photo.agl_m = kAgl;
    photo.is_test = is_test;
    survey.photos.push_back(photo);
  }

  // Of every held-out photo: by metres, and by some degrees.
  void MoveHeldOut() {
    for (survey::Photo& photo : survey.photos) {
      if (!photo.is_test) continue;
      const Eigen::Vector3d centre = photo.cam_from_enu.OriginInSource() + Eigen::Vector3d(7.0, -4.0, -12.0);
      photo.cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitY())) * photo.cam_from_enu.rotation;
      photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * centre);
      photo.agl_m -= 12.0;
    }
  }
};

}  // namespace skyquilt::surface
