#include "tour/ways/look_along.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "products/camera_path.h"

namespace skyquilt::tour {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
// Looking steeper than this at something, the heading would swing round when one passes over it.
constexpr double kSteepestLook_deg = 75.0;
constexpr double kLeastTarget_m = 1.0;
// The rays of both ends pass each other this near, by their length: about 3 degrees.
constexpr double kTargetGap = 0.05;
// Nearer to the common target than this share of what the ends are, one would turn too much.
constexpr double kNearestShare = 0.4;
// Share of an orbit in which the view turns from that of its end to the middle.
constexpr double kOrbitTurn = 0.3;

using Rotations = std::vector<Eigen::Quaterniond>;

struct LookAngles {
  double yaw_deg = 0.0, pitch_deg = 0.0, roll_deg = 0.0;
};

double Wrapped(double deg) {
  // As Math.round of the page: halves upwards.
  return deg - 360.0 * std::floor(deg / 360.0 + 0.5);
}

double Smooth(double u) {
  const double t = std::clamp(u, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

Eigen::Quaterniond RotationOf(const LookAngles& angles) {
  return products::PoseFromAngles(Eigen::Vector3d::Zero(), angles.yaw_deg, angles.pitch_deg, angles.roll_deg).rotation;
}

Eigen::Vector3d Ahead(const Eigen::Quaterniond& rotation) {
  return rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

// Looking straight up or down, yaw and roll turn about the same axis: roll is 0 then.
LookAngles AnglesOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d ahead = Ahead(rotation), side = rotation.conjugate() * Eigen::Vector3d::UnitX();
  const double across = ahead.head<2>().norm();
  const bool steep = across < 1e-9;
  const double yaw = steep ? std::atan2(-side.y(), side.x()) : std::atan2(ahead.x(), ahead.y());
  const Eigen::Vector3d level(std::cos(yaw), -std::sin(yaw), 0.0), below = ahead.cross(level);
  return {yaw * kDegPerRad, std::atan2(ahead.z(), across) * kDegPerRad, steep ? 0.0 : std::atan2(side.dot(below), side.dot(level)) * kDegPerRad};
}

double AngleBetween(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w()));
}

Rotations BetweenEnds(const std::vector<WayPlace>& places, const Pose& from, const Pose& to) {
  const LookAngles a = AnglesOf(from.cam_from_enu), b = AnglesOf(to.cam_from_enu);
  const double yaw = Wrapped(b.yaw_deg - a.yaw_deg), pitch = b.pitch_deg - a.pitch_deg, roll = Wrapped(b.roll_deg - a.roll_deg);
  // Straight down, heading and roll are one: between two such views the angles can make a turn that is none.
  const double turn = std::sqrt(yaw * yaw + pitch * pitch + roll * roll) / kDegPerRad;
  const bool shortest = turn > 2.0 * AngleBetween(from.cam_from_enu, to.cam_from_enu) + 0.3;
  Rotations rotations;
  for (const WayPlace& place : places) {
    const double u = place.share;
    rotations.push_back(shortest ? from.cam_from_enu.slerp(u, to.cam_from_enu)
                                 : RotationOf({a.yaw_deg + yaw * u, a.pitch_deg + pitch * u, a.roll_deg + roll * u}));
  }
  return rotations;
}

// Heading and pitch from a place to another; the heading of what is straight below is `otherwise_deg`.
LookAngles AnglesTo(const Eigen::Vector3d& eye, const Eigen::Vector3d& target, double otherwise_deg) {
  const Eigen::Vector3d d = target - eye;
  const double across = d.head<2>().norm();
  return {across > 1e-9 * (1.0 + d.norm()) ? std::atan2(d.x(), d.y()) * kDegPerRad : otherwise_deg, std::atan2(d.z(), across) * kDegPerRad, 0.0};
}

// What both look at, as the nearest points of the two rays.
std::optional<std::pair<Eigen::Vector3d, Eigen::Vector3d>> CommonTarget(const Pose& from, const Pose& to) {
  const Eigen::Vector3d u = Ahead(from.cam_from_enu), v = Ahead(to.cam_from_enu), between = from.eye_enu - to.eye_enu;
  const double cosine = u.dot(v), sine_square = 1.0 - cosine * cosine;
  if (sine_square < 1e-6) return {};
  const double d = u.dot(between), e = v.dot(between);
  const double s = (cosine * e - d) / sine_square, t = (e - cosine * d) / sine_square;
  if (s < kLeastTarget_m || t < kLeastTarget_m) return {};
  const Eigen::Vector3d first = from.eye_enu + u * s, last = to.eye_enu + v * t;
  if (!((first - last).norm() <= kTargetGap * std::min(s, t))) return {};
  return std::pair(first, last);
}

// Nothing: the ends look at nothing in common, or one would come too near or too much above it.
std::optional<Rotations> TowardsTarget(const std::vector<WayPlace>& places, const Pose& from, const Pose& to) {
  const auto targets = CommonTarget(from, to);
  if (!targets) return {};
  const auto& [first, last] = *targets;
  const double nearest = kNearestShare * std::min((first - from.eye_enu).norm(), (last - to.eye_enu).norm());
  const double roll_from = AnglesOf(from.cam_from_enu).roll_deg, roll = Wrapped(AnglesOf(to.cam_from_enu).roll_deg - roll_from);
  Rotations rotations;
  for (const WayPlace& place : places) {
    const Eigen::Vector3d target = first + (last - first) * place.share;
    LookAngles look = AnglesTo(place.eye_enu, target, 0.0);
    if ((target - place.eye_enu).norm() < nearest || std::abs(look.pitch_deg) > kSteepestLook_deg) return {};
    look.roll_deg = roll_from + roll * place.share;
    rotations.push_back(RotationOf(look));
  }
  return rotations;
}

// Looks at the middle; at each end by the difference there is to the pose.
Rotations AroundMiddle(const std::vector<WayPlace>& places, const Pose& from, const Pose& to, const Eigen::Vector3d& about) {
  const LookAngles a = AnglesOf(from.cam_from_enu), b = AnglesOf(to.cam_from_enu);
  // Straight above the middle the heading is that of the next place, or of the one before.
  const auto far = std::find_if(places.begin(), places.end(), [&](const WayPlace& place) { return (place.eye_enu - about).head<2>().norm() > 1e-6; });
  double heading = far == places.end() ? a.yaw_deg : AnglesTo(far->eye_enu, about, a.yaw_deg).yaw_deg;
  std::vector<LookAngles> looks;
  for (const WayPlace& place : places) {
    looks.push_back(AnglesTo(place.eye_enu, about, heading));
    heading = looks.back().yaw_deg;
  }
  const auto difference = [](const LookAngles& pose, const LookAngles& look) {
    return LookAngles{Wrapped(pose.yaw_deg - look.yaw_deg), pose.pitch_deg - look.pitch_deg, pose.roll_deg};
  };
  const LookAngles at_start = difference(a, looks.front()), at_end = difference(b, looks.back());
  Rotations rotations;
  for (size_t i = 0; i < places.size(); ++i) {
    const double start = 1.0 - Smooth(places[i].share / kOrbitTurn), end = 1.0 - Smooth((1.0 - places[i].share) / kOrbitTurn);
    const double pitch = looks[i].pitch_deg + start * at_start.pitch_deg + end * at_end.pitch_deg;
    rotations.push_back(RotationOf({looks[i].yaw_deg + start * at_start.yaw_deg + end * at_end.yaw_deg, std::clamp(pitch, -90.0, 90.0),
                                    start * at_start.roll_deg + end * at_end.roll_deg}));
  }
  return rotations;
}

}  // namespace

Rotations RotationsAlong(const std::vector<WayPlace>& places, const Pose& from, const Pose& to, const std::optional<Eigen::Vector3d>& about) {
  Rotations rotations;
  if (about) {
    rotations = AroundMiddle(places, from, to, *about);
  } else {
    std::optional<Rotations> towards = TowardsTarget(places, from, to);
    rotations = towards ? std::move(*towards) : BetweenEnds(places, from, to);
  }
  rotations.front() = from.cam_from_enu;
  rotations.back() = to.cam_from_enu;
  return rotations;
}

}  // namespace skyquilt::tour
