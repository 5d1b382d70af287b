// A phone along a road, looking ahead and to both sides in turn.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "simulate/flights/level_flight.h"
#include "simulate/flights/sight.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStepAlongStreet_m = 0.8;  // the photos to one side, every third, overlap by two thirds
constexpr double kRoomForWalker_m = 0.5;
constexpr double kStreetPitch_deg = 3.0;
constexpr double kBesideStreet_m = 25.0;  // buildings nearer than this can be seen well
// Clockwise from ahead. Not square: photos to the side and ahead share a seam.
constexpr std::array<double, 3> kTurns_deg = {0.0, -60.0, 60.0};
constexpr std::array<double, 5> kAside_m = {0.0, 1.0, -1.0, 2.0, -2.0};

// The part of a street that is walked.
struct Walk {
  Vector2d start;
  Vector2d along;  // unit
  double step_m = kStepAlongStreet_m;
};

Walk WalkAlong(const PlaceSpec& place, const std::array<Vector2d, 2>& street) {
  const double length_m = (street[1] - street[0]).norm();
  Walk walk;
  walk.along = (street[1] - street[0]) / length_m;
  walk.step_m = std::min(kStepAlongStreet_m, length_m / (place.level_photos - 1));
  const double walked_m = walk.step_m * (place.level_photos - 1);
  // About the place's middle.
  const double middle_m = walk.along.dot(0.5 * (place.area_min + place.area_max) - street[0]);
  walk.start = street[0] + std::clamp(middle_m - 0.5 * walked_m, 0.0, std::max(length_m - walked_m, 0.0)) * walk.along;
  return walk;
}

std::optional<Vector3d> FreePlaceOnRoad(const World& world, const Walk& walk, int i) {
  for (const double aside_m : kAside_m) {
    const Vector2d at = walk.start + i * walk.step_m * walk.along + aside_m * Vector2d(-walk.along.y(), walk.along.x());
    const Vector3d eye(at.x(), at.y(), GroundZ(world, at) + kEyeHeight_m);
    if (IsFree(world, eye, kRoomForWalker_m)) return eye;
  }
  return std::nullopt;
}

// Nothing when the street is blocked.
std::vector<LevelStation> StationsAlong(const PlaceSpec& place, const World& world, const Walk& walk) {
  std::vector<LevelStation> stations;
  for (int i = 0; i < place.level_photos; ++i) {
    const std::optional<Vector3d> eye = FreePlaceOnRoad(world, walk, i);
    if (!eye) return {};
    const int line = i % static_cast<int>(kTurns_deg.size());
    stations.push_back({*eye, YawOf(walk.along) + kTurns_deg[static_cast<size_t>(line)], kStreetPitch_deg, line});
  }
  return stations;
}

std::ptrdiff_t BuildingsBeside(const World& world, const PlaceSpec& place, const Walk& walk) {
  const Vector2d end = walk.start + walk.step_m * (place.level_photos - 1) * walk.along;
  return std::count_if(world.buildings().begin(), world.buildings().end(), [&](const Building& b) {
    const double along_m = std::clamp(walk.along.dot(b.centre - walk.start), 0.0, (end - walk.start).norm());
    return (walk.start + along_m * walk.along - b.centre).norm() < kBesideStreet_m;
  });
}

}  // namespace

std::vector<LevelStation> StreetStations(const PlaceSpec& place, const World& world) {
  std::vector<LevelStation> best;
  std::ptrdiff_t most = -1;
  for (const std::array<Vector2d, 2>& street : world.city()->StreetsAcross(place.area_min, place.area_max)) {
    const Walk walk = WalkAlong(place, street);
    const std::ptrdiff_t n_buildings = BuildingsBeside(world, place, walk);
    if (n_buildings <= most) continue;
    std::vector<LevelStation> stations = StationsAlong(place, world, walk);
    if (stations.empty()) continue;
    best = std::move(stations);
    most = n_buildings;
  }
  if (best.empty()) {
    throw base::UsageError("simulate.flight = street is not allowed: place '" + place.name + "' with seed " + std::to_string(place.seed) +
                           " has no street that is free; choose another seed or place, or fewer simulate.trucks");
  }
  base::LogInfo("simulate: {:.0f} m along a street with {} buildings beside it", (best.back().position - best.front().position).norm(), most);
  return best;
}

}  // namespace skyquilt::simulate
