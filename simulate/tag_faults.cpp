#include "simulate/tag_faults.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "core/base/random.h"
#include "simulate/flight.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3d;

// Streams of random numbers, one per kind of error.
enum Stream : uint64_t { kJumpStream = 71, kBiasStream, kOutlierStream, kGimbalStream };

constexpr double kJumpAt = 0.6;  // share of the flight's duration

std::vector<Vector3d> TruePositions(const std::vector<PhotoPlan>& photos) {
  std::vector<Vector3d> positions;
  positions.reserve(photos.size());
  for (const PhotoPlan& photo : photos) positions.push_back(photo.cam_from_enu.OriginInSource());
  return positions;
}

// On straight lines between the photos; the first and the last of them go on before and after the flight.
Vector3d PositionAt(double time_s, const std::vector<PhotoPlan>& photos, const std::vector<Vector3d>& positions) {
  if (photos.size() < 2) return positions.front();
  size_t next = 1;
  while (next + 1 < photos.size() && photos[next].time_s < time_s) ++next;
  const double share = (time_s - photos[next - 1].time_s) / (photos[next].time_s - photos[next - 1].time_s);
  return positions[next - 1] + share * (positions[next] - positions[next - 1]);
}

void AddLag(double lag_s, const std::vector<Vector3d>& positions, std::vector<PhotoPlan>& photos) {
  for (size_t i = 0; i < photos.size(); ++i) {
    photos[i].tagged_position += PositionAt(photos[i].time_s - lag_s, photos, positions) - positions[i];
  }
}

void AddDrift(double drift_m, std::vector<PhotoPlan>& photos) {
  const double begin_s = photos.front().time_s;
  const double duration_s = photos.back().time_s - begin_s;
  if (duration_s <= 0.0) return;
  for (PhotoPlan& photo : photos) photo.tagged_position.z() += drift_m * (photo.time_s - begin_s) / duration_s;
}

void AddJump(double jump_m, uint32_t seed, std::vector<PhotoPlan>& photos) {
  base::Random random(seed, kJumpStream);
  const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const Vector3d jump = jump_m * Vector3d(std::cos(direction), std::sin(direction), 0.5);
  const double from_s = photos.front().time_s + kJumpAt * (photos.back().time_s - photos.front().time_s);
  for (PhotoPlan& photo : photos) {
    if (photo.time_s >= from_s) photo.tagged_position += jump;
  }
}

void AddBias(double bias_m, uint32_t seed, std::vector<PhotoPlan>& photos) {
  base::Random random(seed, kBiasStream);
  const double east = random.Normal();
  const double north = random.Normal();
  const Vector3d bias = bias_m * Vector3d(east, north, 1.5 * random.Normal());
  for (PhotoPlan& photo : photos) photo.tagged_position += bias;
}

void AddOutliers(double share, double distance_m, uint32_t seed, std::vector<PhotoPlan>& photos) {
  base::Random random(seed, kOutlierStream);
  std::vector<size_t> order(photos.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto n = static_cast<size_t>(std::lround(share * static_cast<double>(photos.size())));
  for (size_t i = 0; i < n; ++i) {
    std::swap(order[i], order[i + random.Below(static_cast<uint32_t>(order.size() - i))]);
    // Uniform on the sphere: the height of a zone is in proportion to its area.
    const double up = random.Uniform(-1.0, 1.0);
    const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
    const double level = std::sqrt(1.0 - up * up);
    photos[order[i]].tagged_position += distance_m * Vector3d(level * std::cos(direction), level * std::sin(direction), up);
  }
}

// A gimbal of a real drone is level to a few tenths of a degree, with a part that is the same in all photos.
void AddGimbalErrors(const TagFaults& faults, uint32_t seed, std::vector<PhotoPlan>& photos) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  base::Random random(seed, kGimbalStream);
  const double common_x_deg = faults.gimbal_common_error_deg * random.Normal();
  const double common_y_deg = faults.gimbal_common_error_deg * random.Normal();
  for (PhotoPlan& photo : photos) {
    const double x_deg = common_x_deg + faults.gimbal_random_error_deg * random.Normal();
    const double y_deg = common_y_deg + faults.gimbal_random_error_deg * random.Normal();
    const Vector3d turn = kRadians * Vector3d(x_deg, y_deg, 0.0);
    const Eigen::Quaterniond error(Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()));
    photo.tagged_gimbal = GimbalFromPose({error * photo.cam_from_enu.rotation, Vector3d::Zero()});
  }
}

// Over ground, from the neighbouring photos of the same line: between lines the drone turns.
void TagSpeeds(const std::vector<Vector3d>& positions, std::vector<PhotoPlan>& photos) {
  for (size_t i = 0; i < photos.size(); ++i) {
    const size_t before = i > 0 && photos[i - 1].line == photos[i].line ? i - 1 : i;
    const size_t after = i + 1 < photos.size() && photos[i + 1].line == photos[i].line ? i + 1 : i;
    if (before == after) continue;
    const double way_m = (positions[after] - positions[before]).head<2>().norm();
    photos[i].tagged_speed_mps = way_m / (photos[after].time_s - photos[before].time_s);
  }
}

}  // namespace

void ApplyTagFaults(const TagFaults& faults, uint32_t seed, std::vector<PhotoPlan>& photos) {
  if (photos.empty()) return;
  const std::vector<Vector3d> positions = TruePositions(photos);
  if (faults.lag_s != 0.0) AddLag(faults.lag_s, positions, photos);
  if (faults.drift_m != 0.0) AddDrift(faults.drift_m, photos);
  if (faults.jump_m != 0.0) AddJump(faults.jump_m, seed, photos);
  if (faults.bias_m != 0.0) AddBias(faults.bias_m, seed, photos);
  if (faults.outlier_share > 0.0) AddOutliers(faults.outlier_share, faults.outlier_m, seed, photos);
  if (faults.gimbal_common_error_deg > 0.0 || faults.gimbal_random_error_deg > 0.0) AddGimbalErrors(faults, seed, photos);
  if (faults.speed_tags) TagSpeeds(positions, photos);
  for (PhotoPlan& photo : photos) {
    photo.tagged_position.z() += faults.height_offset_m;
    if (faults.equal) photo.tagged_position = photos.front().tagged_position;
    photo.tagged_heights = faults.heights;
    photo.coordinates_swapped = faults.swapped;
    photo.position_tagged = faults.position_tags;
    if (!faults.gimbal_tags) photo.tagged_gimbal.reset();
  }
}

}  // namespace skyquilt::simulate
