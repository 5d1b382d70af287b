#include "prepare/rigs/panorama_views.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prepare/poses/seed/seed_rotation.h"

namespace skyquilt::prepare::rigs {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

}  // namespace

std::vector<PanoramaView> LayOutViews(int per_ring, std::vector<double> pitches_deg) {
  std::stable_sort(pitches_deg.begin(), pitches_deg.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  // A panorama whose middle looks north and level.
  const Eigen::Quaterniond enu_from_pano = poses::RotationFromAngles(0.0, 0.0, 0.0).conjugate();
  const double step_deg = 360.0 / per_ring;
  std::vector<PanoramaView> views;
  for (const double pitch_deg : pitches_deg) {
    const bool is_pole = std::abs(pitch_deg) >= 90.0;
    for (int i = 0; i < (is_pole ? 1 : per_ring); ++i) {
      PanoramaView& view = views.emplace_back();
      view.prefix = fmt::format("pano_view{:02d}/", views.size() - 1);
      view.yaw_deg = std::remainder((i + (pitch_deg > 0.0 && !is_pole ? 0.5 : 0.0)) * step_deg, 360.0);
      view.pitch_deg = pitch_deg;
      view.cam_from_pano = (poses::RotationFromAngles(view.yaw_deg, pitch_deg, 0.0) * enu_from_pano).normalized();
    }
  }
  return views;
}

double ViewFocal(int width, double fov_deg) {
  return 0.5 * width / std::tan(0.5 * fov_deg * kRadians);
}

int WidthAsSharp(int pano_width, double fov_deg) {
  const double focal_px = pano_width / (2.0 * std::numbers::pi);
  return std::max(2, 2 * static_cast<int>(std::lround(focal_px * std::tan(0.5 * fov_deg * kRadians))));
}

Rig RigOf(const std::vector<PanoramaView>& views) {
  Rig rig;
  for (const PanoramaView& view : views) {
    const Eigen::Quaterniond cam_from_rig = (view.cam_from_pano * views.front().cam_from_pano.conjugate()).normalized();
    rig.cameras.push_back({.prefix = view.prefix, .cam_from_rig = {cam_from_rig, Eigen::Vector3d::Zero()}});
  }
  return rig;
}

survey::PhotoTags TagsOfView(const survey::PhotoTags& panorama, const PanoramaView& view, int width, double focal_px) {
  survey::PhotoTags tags = panorama;
  tags.panorama.reset();
  tags.gimbal_yaw_deg.reset();
  tags.gimbal_pitch_deg.reset();
  tags.gimbal_roll_deg.reset();
  if (panorama.panorama && (panorama.panorama->heading_deg || panorama.panorama->pitch_deg || panorama.panorama->roll_deg)) {
    const survey::PanoramaTags& pose = *panorama.panorama;
    const Eigen::Quaterniond pano_from_enu =
        poses::RotationFromAngles(pose.heading_deg.value_or(0.0), pose.pitch_deg.value_or(0.0), pose.roll_deg.value_or(0.0));
    const Angles angles = AnglesOf(view.cam_from_pano * pano_from_enu);
    if (pose.heading_deg) tags.gimbal_yaw_deg = angles.yaw_deg;
    tags.gimbal_pitch_deg = angles.pitch_deg;
    tags.gimbal_roll_deg = angles.roll_deg;
  }
  constexpr double kFilmWidth_mm = 36.0;
  tags.focal_length_mm.reset();
  tags.focal_length_35mm = std::round(kFilmWidth_mm * focal_px / width);
  if (!survey::IsPlausibleFocal35(*tags.focal_length_35mm)) tags.focal_length_35mm.reset();
  tags.calibrated_focal_px = focal_px;
  tags.original_width = tags.original_height = width;
  tags.orientation = 1;
  tags.band_names.clear();
  return tags;
}

Angles AnglesOf(const Eigen::Quaterniond& cam_from_enu) {
  const Eigen::Matrix3d axes = cam_from_enu.normalized().toRotationMatrix();  // rows: right, down, forward in ENU
  const Eigen::Vector3d right = axes.row(0), down = axes.row(1), forward = axes.row(2);
  Angles angles;
  angles.pitch_deg = std::atan2(forward.z(), std::hypot(forward.x(), forward.y())) / kRadians;
  // Straight up and down yaw and roll turn about one axis: all of it is yaw, by the picture's upper edge.
  constexpr double kPole = 1e-9;
  const bool is_pole = std::hypot(forward.x(), forward.y()) < kPole;
  const Eigen::Vector3d along = !is_pole ? forward : forward.z() < 0.0 ? Eigen::Vector3d(-down) : down;
  const double yaw = std::atan2(along.x(), along.y());
  angles.yaw_deg = yaw / kRadians;
  if (is_pole) return angles;
  const Eigen::Vector3d level_right(std::cos(yaw), -std::sin(yaw), 0.0);
  angles.roll_deg = std::atan2(right.dot(forward.cross(level_right)), right.dot(level_right)) / kRadians;
  return angles;
}

}  // namespace skyquilt::prepare::rigs
