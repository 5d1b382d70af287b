#include "tour/propose/choose_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "products/camera_path.h"

namespace skyquilt::tour {
namespace {

constexpr double kFovy_deg = 50.0;
constexpr double kClearance_m = 2.0;
constexpr double kSightClearance_m = 0.5;
constexpr double kSubjectOfPicture = 0.6;  // of the height of the picture
constexpr double kNearest_m = 8.0;
constexpr int kBearings = 16;
constexpr double kBestPitch_deg = 35.0;
constexpr double kPitches_deg[] = {35.0, 30.0, 42.0, 50.0, 60.0, 70.0};
constexpr double kDistances[] = {1.0, 1.3, 1.7};
constexpr double kOverviewPitch_deg = 40.0;
constexpr double kOverviewOfPicture = 0.9;  // of its width and height
constexpr double kWidePicture = 16.0 / 9.0;
constexpr double kMostDistance = 4.0;  // half diagonals
// Above what no photo saw the picture is poor: as bad as half a radian from the best bearing.
constexpr double kNothingBelow = 0.5;

double Radians(double deg) {
  return deg * std::numbers::pi / 180.0;
}

Pose LookingAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  return {.eye_enu = eye, .cam_from_enu = products::PoseLookingAt(eye, target).rotation.normalized(), .fovy_deg = kFovy_deg};
}

// From the eye to where the subject begins.
bool IsInSight(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, const Subject& subject, const Heights& heights) {
  const Eigen::Vector3d way = target - eye;
  const double end = 1.0 - subject.radius_m / way.head<2>().norm();
  const double step_m = 0.5 * heights.cell_m().minCoeff();
  const int steps = std::max(1, static_cast<int>(std::ceil(way.head<2>().norm() * end / step_m)));
  for (int k = 0; k <= steps; ++k) {
    const Eigen::Vector3d x = eye + way * (end * k / steps);
    const std::optional<double> top = heights.At(x.x(), x.y());
    if (top && x.z() < *top + kSightClearance_m) return false;
  }
  return true;
}

}  // namespace

Pose ViewOf(const Subject& subject, const Eigen::Vector2d& middle_of_survey, const Heights* heights) {
  const Eigen::Vector3d target = subject.foot_enu + Eigen::Vector3d(0.0, 0.0, 0.5 * subject.height_m);
  const double extent = std::hypot(subject.radius_m, 0.5 * subject.height_m);
  const double near_m = std::max(kNearest_m, extent / (kSubjectOfPicture * std::tan(Radians(0.5 * kFovy_deg))) + subject.radius_m);
  const Eigen::Vector2d outwards = target.head<2>() - middle_of_survey;
  const double out = outwards.norm() > 1e-6 ? std::atan2(outwards.y(), outwards.x()) : -0.5 * std::numbers::pi;
  std::optional<Eigen::Vector3d> best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (const double pitch_deg : kPitches_deg) {
    for (const double distance : kDistances) {
      for (int k = 0; k < kBearings; ++k) {
        const double turn = 2.0 * std::numbers::pi * (k <= kBearings / 2 ? k : k - kBearings) / kBearings;
        double cost = std::abs(pitch_deg - kBestPitch_deg) / 10.0 + 2.0 * (distance - 1.0) + std::abs(turn);
        const double pitch = Radians(pitch_deg), bearing = out + turn;
        const Eigen::Vector3d eye =
            target + near_m * distance * Eigen::Vector3d(std::cos(pitch) * std::cos(bearing), std::cos(pitch) * std::sin(bearing), std::sin(pitch));
        if (heights != nullptr && !heights->At(eye.x(), eye.y())) cost += kNothingBelow;
        if (!(cost < best_cost)) continue;
        const bool good =
            heights == nullptr || (heights->Dilated(eye.x(), eye.y(), kClearance_m) <= eye.z() && IsInSight(eye, target, subject, *heights));
        if (!good) continue;
        best = eye;
        best_cost = cost;
      }
    }
  }
  if (best) return LookingAt(*best, target);
  const double floor = heights->Dilated(target.x(), target.y(), kClearance_m);
  return LookingAt({target.x(), target.y(), std::max(target.z() + near_m, floor)}, target);
}

Pose Overview(const Eigen::AlignedBox3d& box_enu, double ground_m) {
  const Eigen::Vector2d middle = box_enu.center().head<2>();
  const double radius = std::max(1.0, 0.5 * box_enu.sizes().head<2>().norm());
  const double pitch = Radians(kOverviewPitch_deg), half_height = kOverviewOfPicture * std::tan(Radians(0.5 * kFovy_deg));
  const Eigen::Vector3d target(middle.x(), middle.y(), ground_m);
  const auto from = [&](double distance) {
    Eigen::Vector3d eye = target + distance * radius * Eigen::Vector3d(0.0, -std::cos(pitch), std::sin(pitch));
    eye.z() = std::max(eye.z(), box_enu.max().z() + kClearance_m);
    return LookingAt(eye, target);
  };
  const auto shows_all = [&](const Pose& pose) {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d x = box_enu.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
      const Eigen::Vector3d in_cam = pose.cam_from_enu * (x - pose.eye_enu);
      if (!(in_cam.z() > 0.0 && std::abs(in_cam.y()) <= half_height * in_cam.z() &&
            std::abs(in_cam.x()) <= kWidePicture * half_height * in_cam.z())) {
        return false;
      }
    }
    return true;
  };
  double near = 0.0, far = kMostDistance;
  for (int halving = 0; halving < 20; ++halving) {
    const double distance = 0.5 * (near + far);
    (shows_all(from(distance)) ? far : near) = distance;
  }
  return from(far);
}

}  // namespace skyquilt::tour
