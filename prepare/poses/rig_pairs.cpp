#include "prepare/poses/rig_pairs.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include "core/geo/ecef.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

struct RigShot {
  std::vector<uint32_t> photos;
  std::optional<Eigen::Vector3d> place;  // ECEF metres, without height
  double time_s = 0.0;
};

bool HasPlace(const survey::PhotoTags& tags) {
  return tags.gps && geo::IsValid({tags.gps->latitude_deg, tags.gps->longitude_deg, 0.0});
}

// In the order of time, without it of names.
std::vector<RigShot> ShotsOf(const std::vector<input::PhotoFile>& photos) {
  std::map<std::string, RigShot> by_name;
  for (uint32_t i = 0; i < photos.size(); ++i) {
    if (!photos[i].rig) continue;
    RigShot& shot = by_name[photos[i].rig->shot];
    const survey::PhotoTags& tags = photos[i].tags;
    if (shot.photos.empty()) shot.time_s = tags.capture_time_s.value_or(0.0);
    if (!shot.place && HasPlace(tags)) shot.place = geo::EcefFromGeodetic({tags.gps->latitude_deg, tags.gps->longitude_deg, 0.0});
    shot.photos.push_back(i);
  }
  std::vector<RigShot> shots;
  for (auto& [name, shot] : by_name) shots.push_back(std::move(shot));
  std::stable_sort(shots.begin(), shots.end(), [](const RigShot& a, const RigShot& b) { return a.time_s < b.time_s; });
  return shots;
}

double Distance(const RigShot& a, const RigShot& b) {
  return (*a.place - *b.place).norm();
}

// Numbers of shots, the smaller first.
PhotoPairs PairsByPlace(const std::vector<RigShot>& shots, size_t neighbors) {
  PhotoPairs pairs;
  for (uint32_t i = 0; i < shots.size(); ++i) {
    std::vector<std::pair<double, uint32_t>> others;
    for (uint32_t k = 0; k < shots.size(); ++k) {
      if (k != i) others.emplace_back(Distance(shots[i], shots[k]), k);
    }
    const size_t n = std::min(neighbors, others.size());
    std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(n), others.end());
    for (size_t k = 0; k < n; ++k) pairs.push_back(MakePair(i, others[k].second));
  }
  SortPairs(pairs);
  constexpr size_t kLinks = 1;
  ConnectGroups(
      shots.size(), kLinks,
      [&](uint32_t i) {
        std::vector<double> costs;
        for (const RigShot& other : shots) costs.push_back(Distance(shots[i], other));
        return costs;
      },
      pairs);
  return pairs;
}

std::optional<Eigen::Vector3d> AxisByTags(const survey::PhotoTags& tags) {
  if (!tags.gimbal_yaw_deg || !tags.gimbal_pitch_deg) return std::nullopt;
  const double yaw = *tags.gimbal_yaw_deg * kRadians, pitch = *tags.gimbal_pitch_deg * kRadians;
  return Eigen::Vector3d(std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch));
}

Eigen::Vector3d AxisOnRig(const input::RigPlace& place) {
  return place.cam_from_rig.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

bool LookAlike(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  static const double kLeast = std::cos(kMostApart_deg * kRadians);
  return a.dot(b) >= kLeast;
}

}  // namespace

PhotoPairs PairsOfRigs(const std::vector<input::PhotoFile>& photos, size_t neighbors) {
  const std::vector<RigShot> shots = ShotsOf(photos);
  PhotoPairs pairs;
  for (const RigShot& shot : shots) {
    for (size_t i = 0; i < shot.photos.size(); ++i) {
      for (size_t k = i + 1; k < shot.photos.size(); ++k) {
        const uint32_t a = shot.photos[i], b = shot.photos[k];
        if (LookAlike(AxisOnRig(*photos[a].rig), AxisOnRig(*photos[b].rig))) pairs.push_back(MakePair(a, b));
      }
    }
  }
  const bool placed = std::all_of(shots.begin(), shots.end(), [](const RigShot& shot) { return shot.place.has_value(); });
  PhotoPairs of_shots;
  if (placed) {
    of_shots = PairsByPlace(shots, neighbors);
  } else {
    for (uint32_t i = 0; i < shots.size(); ++i) {
      for (uint32_t k = i + 1; k < shots.size() && k <= i + neighbors; ++k) of_shots.push_back({i, k});
    }
  }
  for (const PhotoPair& pair : of_shots) {
    for (const uint32_t a : shots[pair.a].photos) {
      for (const uint32_t b : shots[pair.b].photos) {
        const std::optional<Eigen::Vector3d> axis_a = AxisByTags(photos[a].tags), axis_b = AxisByTags(photos[b].tags);
        if (!axis_a || !axis_b || LookAlike(*axis_a, *axis_b)) pairs.push_back(MakePair(a, b));
      }
    }
  }
  SortPairs(pairs);
  return pairs;
}

bool RigsTellAllPairs(const std::vector<input::PhotoFile>& photos) {
  return std::all_of(photos.begin(), photos.end(), [](const input::PhotoFile& photo) { return photo.rig && HasPlace(photo.tags); });
}

}  // namespace skyquilt::prepare::poses
