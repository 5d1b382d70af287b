#include "prepare/georeference/gimbal_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/order_statistics.h"
#include "prepare/georeference/gravity.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector3d;

constexpr double kDegreesPerTurn = 180.0 / std::numbers::pi;
constexpr double kClearer_deg = 10.0;  // a witness votes for the nearer direction when it is nearer by this
constexpr double kClearlyAbove = 0.3;  // cosine

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return kDegreesPerTurn * std::atan2(a.cross(b).norm(), a.dot(b));
}

Vector3d MedianOf(const std::vector<Vector3d>& points) {
  Vector3d median;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    values.reserve(points.size());
    for (const Vector3d& x : points) values.push_back(x[axis]);
    median[axis] = base::Median(std::move(values));
  }
  return median;
}

// Positive: speaks for the camera axes; negative: for the gimbal; 0: says nothing.
int Vote(double to_cameras_deg, double to_gimbal_deg) {
  return to_cameras_deg + kClearer_deg < to_gimbal_deg ? 1 : to_gimbal_deg + kClearer_deg < to_cameras_deg ? -1 : 0;
}

// Cameras are above what they see.
int VoteOfSides(const std::vector<input::PreparedPhoto>& photos, const std::vector<Vector3d>& points, const Vector3d& by_cameras,
                const Vector3d& by_gimbal) {
  if (points.empty()) return 0;
  std::vector<Vector3d> centres;
  centres.reserve(photos.size());
  for (const input::PreparedPhoto& photo : photos) centres.push_back(photo.cam_from_model.OriginInSource());
  const Vector3d way = MedianOf(centres) - MedianOf(points);
  if (!(way.norm() > 0.0)) return 0;
  const double cameras = way.normalized().dot(by_cameras), gimbal = way.normalized().dot(by_gimbal);
  return cameras > kClearlyAbove && gimbal < -kClearlyAbove ? 1 : gimbal > kClearlyAbove && cameras < -kClearlyAbove ? -1 : 0;
}

// Whether the right axes of the cameras are level for this direction of up.
bool IsLevel(const std::vector<input::PreparedPhoto>& photos, const Vector3d& up) {
  constexpr double kLevel = 0.26;  // sine of 15 degrees
  std::vector<double> off;
  off.reserve(photos.size());
  for (const input::PreparedPhoto& photo : photos) off.push_back(std::abs((photo.cam_from_model.rotation.conjugate() * Vector3d::UnitX()).dot(up)));
  return base::Median(std::move(off)) < kLevel;
}

}  // namespace

GimbalVerdict JudgeGimbal(const std::vector<input::PreparedPhoto>& photos, const std::vector<Vector3d>& points, const UpByTagsFunction& tags_up) {
  const std::vector<UpEvidence> gimbal = GimbalEvidence(photos);
  const std::vector<UpEvidence> cameras = CameraEvidence(photos, tags_up);
  if (gimbal.empty() || cameras.empty()) return {};
  const Vector3d &by_gimbal = gimbal.front().up, &by_cameras = cameras.front().up;
  const double angle_deg = AngleBetween(by_gimbal, by_cameras);
  if (!(angle_deg > kGimbalConflict_deg)) return {};
  // By the angles the pictures are level, and only the tilt differs: so it is too when all cameras look the same way, at an angle or at a wall, and
  // the camera axes know nothing of it. Then only the tagged positions can contradict the angles.
  constexpr double kOpposite_deg = 120.0;
  const bool level = angle_deg < kOpposite_deg && IsLevel(photos, by_gimbal);

  const int sides = VoteOfSides(photos, points, by_cameras, by_gimbal);
  int ground_vote = 0;
  if (const std::vector<UpEvidence> ground = GroundEvidence(points, by_cameras); !ground.empty()) {
    // The normal of a plane has no sign.
    const Vector3d& normal = ground.front().up;
    const auto to_normal = [&](const Vector3d& up) { return AngleBetween(normal.dot(up) < 0.0 ? Vector3d(-up) : up, normal); };
    ground_vote = Vote(to_normal(by_cameras), to_normal(by_gimbal));
  }
  int tags_vote = 0;
  if (const std::optional<Vector3d> tags = tags_up()) tags_vote = Vote(AngleBetween(*tags, by_cameras), AngleBetween(*tags, by_gimbal));
  const int votes = sides + ground_vote + tags_vote;
  // The plane may be a wall.
  const bool certain = tags_vote > 0 || (sides > 0 && !level);
  if (votes > 0 && certain) return {GimbalUse::kDropped, angle_deg};
  if (votes < 0 || level) return {};
  return {GimbalUse::kDoubted, angle_deg};
}

GimbalFault FaultOfAngles(const Vector3d& tagged, const Vector3d& found) {
  if (!(AngleBetween(tagged, found) > kGimbalConflict_deg)) return GimbalFault::kNone;
  constexpr double kSame = 1e-9;
  if ((tagged - input::UpInCamera(0.0, 0.0)).norm() < kSame) return GimbalFault::kAllZero;
  const Vector3d other_sign(tagged.x(), tagged.y(), -tagged.z());
  if (!(AngleBetween(other_sign, found) > kGimbalConflict_deg)) return GimbalFault::kOppositePitch;
  // Pitch less a right angle.
  const Vector3d from_down(tagged.x(), -tagged.z(), tagged.y());
  if (!(AngleBetween(from_down, found) > kGimbalConflict_deg)) return GimbalFault::kFromStraightDown;
  return GimbalFault::kOther;
}

}  // namespace skyquilt::prepare::georeference
