// A drone round a house or tower at two heights, looking at its middle.
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

constexpr double kRoomForDrone_m = 1.5;
constexpr double kFromBuilding_m = 3.0;  // of its corners, at least
constexpr double kSmallestBuilding_m = 6.0;
// Rise or fall of the view per metre, at least and at the nearest.
constexpr double kUsualSlope = 0.34, kSteepestSlope = 0.385;
constexpr int kTriedAngles = 16;
// Where something is in the way: of the radius, and of the step between stations.
constexpr std::array<double, 7> kRadiusFactors = {1.0, 0.9, 1.1, 0.8, 1.25, 0.65, 1.5};
constexpr std::array<double, 4> kAngleShifts = {0.0, 0.25, -0.25, 0.5};

struct OrbitTarget {
  const Outline* building = nullptr;
  Vector3d middle = Vector3d::Zero();
  double ground_z_m = 0.0;
  double reach_m = 0.0;  // of the corners, from the middle
  double height_m = 0.0;
};

std::optional<OrbitTarget> TargetOf(const World& world, const Outline& outline) {
  if (outline.length_m < kSmallestBuilding_m) return std::nullopt;
  OrbitTarget target;
  target.building = &outline;
  target.ground_z_m = world.buildings()[outline.largest].ground_z_m;
  for (size_t i = outline.first; i < outline.first + outline.n_parts; ++i) {
    target.height_m = std::max(target.height_m, world.buildings()[i].ridge_height_m);
  }
  // A courtyard's middle is empty.
  const Vector2d at = outline.holes.empty() ? outline.centre : world.buildings()[outline.largest].centre;
  target.middle = {at.x(), at.y(), target.ground_z_m + 0.5 * target.height_m};
  target.reach_m = 0.5 * std::hypot(outline.length_m, outline.width_m) + (at - outline.centre).norm();
  return target;
}

double SlopeTo(const OrbitTarget& target, double height_m, double radius_m) {
  return std::abs(target.ground_z_m + height_m - target.middle.z()) / radius_m;
}

double RadiusAt(const OrbitTarget& target, double height_m) {
  return std::max(1.5 * target.reach_m + 6.0, SlopeTo(target, height_m, 1.0) / kUsualSlope);
}

std::optional<Vector3d> DroneAt(const World& world, const OrbitTarget& target, double height_m, double radius_m, double angle_rad) {
  if (radius_m < target.reach_m + kFromBuilding_m || SlopeTo(target, height_m, radius_m) > kSteepestSlope) return std::nullopt;
  const Vector2d at = target.middle.head<2>() + radius_m * Vector2d(std::cos(angle_rad), std::sin(angle_rad));
  const Vector3d drone(at.x(), at.y(), target.ground_z_m + height_m);
  if (drone.z() < GroundZ(world, at) + kRoomForDrone_m || !IsFree(world, drone, kRoomForDrone_m)) return std::nullopt;
  if (!SeesBuilding(world, drone, target.middle, *target.building)) return std::nullopt;
  return drone;
}

// The building with the freest sight from all around; a high one rather than a low one.
std::optional<OrbitTarget> ChooseTarget(const PlaceSpec& place, const World& world, const std::vector<Outline>& outlines) {
  constexpr double kStationsPerMetre = 0.3;
  std::optional<OrbitTarget> best;
  double best_score = 0.0;
  for (const Outline& outline : outlines) {
    if ((outline.centre - place.area_min).minCoeff() < 0.0 || (place.area_max - outline.centre).minCoeff() < 0.0) continue;
    const std::optional<OrbitTarget> target = TargetOf(world, outline);
    if (!target) continue;
    int n_free = 0;
    for (const double height_m : kOrbitHeights_m) {
      for (int i = 0; i < kTriedAngles; ++i) {
        if (DroneAt(world, *target, height_m, RadiusAt(*target, height_m), 2.0 * std::numbers::pi * i / kTriedAngles)) ++n_free;
      }
    }
    const double score = n_free + kStationsPerMetre * target->height_m;
    if (n_free == 0 || score <= best_score) continue;
    best = target;
    best_score = score;
  }
  return best;
}

std::optional<Vector3d> NearAngle(const World& world, const OrbitTarget& target, double height_m, double angle_rad, double step_rad) {
  for (const double factor : kRadiusFactors) {
    for (const double shift : kAngleShifts) {
      const std::optional<Vector3d> drone = DroneAt(world, target, height_m, factor * RadiusAt(target, height_m), angle_rad + shift * step_rad);
      if (drone) return drone;
    }
  }
  return std::nullopt;
}

}  // namespace

std::vector<LevelStation> OrbitStations(const PlaceSpec& place, const World& world) {
  const std::vector<Outline> outlines = FindOutlines(world.buildings());
  const std::optional<OrbitTarget> target = ChooseTarget(place, world, outlines);
  std::vector<LevelStation> stations;
  const int n_rings = static_cast<int>(kOrbitHeights_m.size());
  for (int ring = 0; target && ring < n_rings; ++ring) {
    const int n = (place.level_photos + n_rings - 1 - ring) / n_rings;
    const double step_rad = 2.0 * std::numbers::pi / n;
    for (int i = 0; i < n; ++i) {
      // Stations of the upper ring are between those of the lower one.
      const double angle_rad = (i + 0.5 * ring) * step_rad;
      const std::optional<Vector3d> drone = NearAngle(world, *target, kOrbitHeights_m[static_cast<size_t>(ring)], angle_rad, step_rad);
      if (!drone) continue;
      const Vector3d view = target->middle - *drone;
      const double pitch_deg = std::atan2(view.z(), view.head<2>().norm()) * 180.0 / std::numbers::pi;
      stations.push_back({*drone, YawOf(view.head<2>()), pitch_deg, ring});
    }
  }
  const auto n_found = static_cast<int>(stations.size());
  if (2 * n_found < place.level_photos) {
    throw base::UsageError("simulate.flight = orbit is not allowed: place '" + place.name + "' with seed " + std::to_string(place.seed) +
                           " has no house or tower with free sight from all around; choose another seed or place");
  }
  if (n_found < place.level_photos) {
    base::LogWarning("simulate: the building is in sight from {} of {} stations of the orbit (simulate.photos)", n_found, place.level_photos);
  }
  base::LogInfo("simulate: an orbit round a {} {:.1f} m high", KindName(world.buildings()[target->building->largest].kind), target->height_m);
  return stations;
}

}  // namespace skyquilt::simulate
