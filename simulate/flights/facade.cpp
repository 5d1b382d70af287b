// A phone along the longest house front, looking at the wall and a little up.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "simulate/flights/level_flight.h"
#include "simulate/flights/sight.h"
#include "simulate/outline.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kShortestFront_m = 5.0;
constexpr double kNearestToFront_m = 2.5, kFarthestFromFront_m = 25.0;
constexpr double kRoomForPhone_m = 0.4;
constexpr double kLowestPitch_deg = 8.0, kHighestPitch_deg = 16.0;
// Of the stations; trees may hide the wall from the others.
constexpr double kShareThatSeesTheWall = 0.75;
// Of the distance, where something stands in the way.
constexpr std::array<double, 10> kDistanceFactors = {1.0, 0.9, 1.1, 0.8, 1.2, 0.7, 1.3, 0.6, 1.5, 0.5};
// Cars and trees nearer than this share of the distance to the wall are in the way of the picture.
constexpr double kInTheWay = 0.5;

// One straight side of a building on the ground.
struct Front {
  Vector2d middle;
  Vector2d along;  // unit, to the right for somebody who looks at it
  Vector2d out;    // unit, away from the building
  double length_m = 0.0;
  double wall_m = 0.0;  // about its height
  const Outline* building = nullptr;
};

// In the surveyed area, the longest first.
std::vector<Front> FrontsIn(const PlaceSpec& place, const World& world, const std::vector<Outline>& outlines) {
  std::vector<Front> fronts;
  for (const Outline& outline : outlines) {
    for (size_t i = 0; i < outline.walls.size(); ++i) {
      const Vector2d& from = outline.walls[i];
      const Vector2d& to = outline.walls[(i + 1) % outline.walls.size()];
      Front front;
      front.middle = 0.5 * (from + to);
      front.length_m = (to - from).norm();
      if (front.length_m < kShortestFront_m) continue;
      if ((front.middle - place.area_min).minCoeff() < 0.0 || (place.area_max - front.middle).minCoeff() < 0.0) continue;
      // The ring is counter-clockwise: the building is to its left.
      front.along = (to - from) / front.length_m;
      front.out = {front.along.y(), -front.along.x()};
      front.wall_m = world.buildings()[outline.largest].eave_height_m;
      front.building = &outline;
      fronts.push_back(front);
    }
  }
  std::stable_sort(fronts.begin(), fronts.end(), [](const Front& a, const Front& b) { return a.length_m > b.length_m; });
  return fronts;
}

bool IsThing(Part part) {
  return part == Part::kCarBody || part == Part::kCarGlass || part == Part::kCarTyre || part == Part::kTrunk || part == Part::kLeaves;
}

// How many of a grid of the picture's rays end on things nearer than near_m.
int RaysInTheWay(const PlaceSpec& place, const World& world, const Front& front, const Vector3d& eye, double pitch_deg, double near_m) {
  constexpr int kColumns = 13, kRows = 9;
  const double pitch = pitch_deg * std::numbers::pi / 180.0;
  const Vector3d right(front.along.x(), front.along.y(), 0.0), level(-front.out.x(), -front.out.y(), 0.0);
  const Vector3d ahead = std::cos(pitch) * level + std::sin(pitch) * Vector3d::UnitZ();
  const Vector3d upwards = std::cos(pitch) * Vector3d::UnitZ() - std::sin(pitch) * level;
  int n = 0;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const double x = (i % kColumns + 0.5) / kColumns - 0.5, y = (i / kColumns + 0.5) / kRows - 0.5;
    const Vector3d ray = place.camera.FocalX() * ahead + x * place.camera.width * right - y * place.camera.height * upwards;
    const std::optional<Sighting> seen = LookAlong(world, eye, ray.normalized());
    if (seen && seen->distance_m < near_m && IsThing(seen->tag.part)) ++n;
  }
  return n;
}

// Of the free places at several distances the first with least in the way, as a photographer steps round a parked car.
std::optional<Vector3d> PlaceBefore(const PlaceSpec& place, const World& world, const Front& front, double along_m, double distance_m,
                                    double pitch_deg) {
  std::optional<Vector3d> best;
  int least = 0;
  for (const double factor : kDistanceFactors) {
    const Vector2d at = front.middle + along_m * front.along + factor * distance_m * front.out;
    const Vector3d eye(at.x(), at.y(), GroundZ(world, at) + kEyeHeight_m);
    if (!IsFree(world, eye, kRoomForPhone_m)) continue;
    const int n = RaysInTheWay(place, world, front, eye, pitch_deg, kInTheWay * factor * distance_m);
    if (best && n >= least) continue;
    best = eye;
    least = n;
    if (n == 0) break;
  }
  return best;
}

// Nothing when there is no room, or too little sight.
std::vector<LevelStation> StationsBefore(const PlaceSpec& place, const World& world, const Front& front) {
  const int n = place.level_photos;
  const double step_per_m = (1.0 - place.forward_overlap) * place.camera.width / place.camera.FocalX();
  const double distance_m = std::clamp(front.length_m / ((n - 1) * step_per_m), kNearestToFront_m, kFarthestFromFront_m);
  const double step_m = std::min(step_per_m * distance_m, front.length_m / (n - 1));
  const double to_middle_deg = std::atan2(0.5 * front.wall_m - kEyeHeight_m, distance_m) * 180.0 / std::numbers::pi;
  const double pitch_deg = std::clamp(to_middle_deg, kLowestPitch_deg, kHighestPitch_deg);
  std::vector<LevelStation> stations;
  int n_see = 0;
  for (int i = 0; i < n; ++i) {
    const std::optional<Vector3d> eye = PlaceBefore(place, world, front, (i - 0.5 * (n - 1)) * step_m, distance_m, pitch_deg);
    if (!eye) return {};
    // The ends look past the corners.
    const double inside_m = std::clamp(front.along.dot(eye->head<2>() - front.middle), -0.5 * front.length_m + 0.3, 0.5 * front.length_m - 0.3);
    const Vector2d foot = front.middle + inside_m * front.along;
    if (SeesBuilding(world, *eye, {foot.x(), foot.y(), eye->z()}, *front.building)) ++n_see;
    stations.push_back({*eye, YawOf(-front.out), pitch_deg, 0});
  }
  if (n_see < kShareThatSeesTheWall * n) return {};
  return stations;
}

}  // namespace

std::vector<LevelStation> FacadeStations(const PlaceSpec& place, const World& world) {
  const std::vector<Outline> outlines = FindOutlines(world.buildings());
  for (const Front& front : FrontsIn(place, world, outlines)) {
    std::vector<LevelStation> stations = StationsBefore(place, world, front);
    if (stations.empty()) continue;
    const double distance_m = front.out.dot(stations.front().position.head<2>() - front.middle);
    base::LogInfo("simulate: a front of {:.1f} m from {:.1f} m away", front.length_m, distance_m);
    return stations;
  }
  throw base::UsageError("simulate.flight = facade is not allowed: place '" + place.name + "' with seed " + std::to_string(place.seed) +
                         " has no house front with room for " + std::to_string(place.level_photos) +
                         " photos before it; choose another seed, place or number of photos");
}

}  // namespace skyquilt::simulate
