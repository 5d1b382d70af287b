// What stands and walks in the streets of a city when it is asked for: a bridge, trucks and containers, lamps, people.
#include <algorithm>
#include <cmath>
#include <utility>

#include "simulate/city_layout.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr double kFromCrossing_m = 13.0;   // parked cars keep the same distance
constexpr double kBetweenPlaces_m = 3.0;   // where a truck could stand
constexpr double kBetweenTrucks_m = 10.0;  // of their centres
constexpr double kOntoPavement_m = 0.35;   // wheels on the pavement leave room for moving cars
constexpr double kHalfCar_m = 2.6;
constexpr double kBehindKerb_m = 0.4, kBetweenLamps_m = 12.0, kFromTrunk_m = 1.0, kFromTruck_m = 0.6;  // of lamps

double DistanceToTruck(const Car& truck, const Vector2d& at) {
  const Vector2d local = PlaneTurn(truck.position, truck.yaw_deg).TurnedBack(at) - truck.position;
  return DistanceToRectangle(local, {0.5 * kTruckLength_m, 0.5 * kTruckWidth_m});
}

}  // namespace

void CityLayout::AddBridge(base::Random& random) {
  const double pitch = static_cast<double>(pitch_);
  const Vector2d phase = phase_.cast<double>();
  // The crossing nearest to the middle of the place.
  const Vector2d middle = turn_.TurnedBack(turn_.about());
  const Eigen::Vector2i crossing = ((middle - phase) / pitch).array().round().cast<int>();
  Bridge bridge;
  const bool along_x = random.UniformDouble() < 0.5;
  bridge.centre = turn_.Turned(phase + pitch * crossing.cast<double>());
  bridge.yaw_deg = turn_.TurnedYaw(along_x ? 0.0 : 90.0);
  bridge.street = along_x ? crossing.y() * 2 + 1 : crossing.x() * 2;
  bridge.height_m = random.Uniform(5.0, 6.0);
  std::erase_if(contents_.trees, [&](const Tree& tree) { return bridge.DistanceTo(tree.position) < kCrownReach * tree.crown_radius_m; });
  std::erase_if(contents_.parked, [&](const Car& car) { return bridge.DistanceTo(car.position) < kHalfCar_m; });
  contents_.bridge = bridge;
}

void CityLayout::AddTrucks(const CityPlan& plan, base::Random& random) {
  std::vector<Car> places;
  const double pitch = static_cast<double>(pitch_);
  const double across = static_cast<double>(kRoadHalfWidth) - 0.5 * kTruckWidth_m + kOntoPavement_m;
  for (const int axis : {0, 1}) {
    const bool along_x = axis == 1;
    for (const Lane& lane : LanesAcross(axis, plan.trucks_min, plan.trucks_max)) {
      for (double at = lane.from + 0.5 * kTruckLength_m; at < lane.to - 0.5 * kTruckLength_m; at += kBetweenPlaces_m) {
        if (std::abs(std::remainder(at - static_cast<double>(phase_[1 - axis]), pitch)) < kFromCrossing_m) continue;
        for (const double side : {-1.0, 1.0}) {
          const double line = lane.line + side * across;
          Car truck;
          truck.position = turn_.Turned(along_x ? Vector2d(at, line) : Vector2d(line, at));
          truck.yaw_deg = turn_.TurnedYaw((along_x ? 0.0 : 90.0) + (side > 0.0 ? 180.0 : 0.0));
          places.push_back(truck);
        }
      }
    }
  }
  for (size_t n = places.size(); n > 1; --n) std::swap(places[n - 1], places[random.Below(static_cast<uint32_t>(n))]);
  std::vector<Car> trucks;
  for (Car& truck : places) {
    if (trucks.size() == static_cast<size_t>(plan.trucks)) break;
    truck.seed = random.NextU32();
    truck.kind = random.UniformDouble() < 0.5 ? CarKind::kTruck : CarKind::kContainer;
    const bool free =
        std::all_of(trucks.begin(), trucks.end(), [&](const Car& other) { return (other.position - truck.position).norm() > kBetweenTrucks_m; }) &&
        std::all_of(contents_.trees.begin(), contents_.trees.end(),
                    [&](const Tree& tree) { return DistanceToTruck(truck, tree.position) > kCrownReach * tree.crown_radius_m; }) &&
        (!contents_.bridge || contents_.bridge->DistanceTo(truck.position) > kTruckLength_m);
    if (free) trucks.push_back(truck);
  }
  for (const Car& truck : trucks) std::erase_if(contents_.parked, [&](const Car& car) { return DistanceToTruck(truck, car.position) < kHalfCar_m; });
  contents_.parked.insert(contents_.parked.end(), trucks.begin(), trucks.end());
}

void CityLayout::AddLamps(const CityPlan& plan, base::Random& random) {
  std::vector<Lamp> places;
  const double pitch = static_cast<double>(pitch_), across = static_cast<double>(kRoadHalfWidth) + kBehindKerb_m;
  for (const int axis : {0, 1}) {
    const bool along_x = axis == 1;
    for (const Lane& lane : LanesAcross(axis, plan.trucks_min, plan.trucks_max)) {
      for (double at = lane.from; at < lane.to; at += kBetweenLamps_m) {
        if (std::abs(std::remainder(at - static_cast<double>(phase_[1 - axis]), pitch)) < across) continue;  // in the side street
        for (const double side : {-1.0, 1.0}) {
          const double line = lane.line + side * across;
          Lamp lamp;
          lamp.position = turn_.Turned(along_x ? Vector2d(at, line) : Vector2d(line, at));
          // Its arm reaches above the road.
          lamp.yaw_deg = turn_.TurnedYaw(along_x ? -90.0 * side : (side > 0.0 ? 180.0 : 0.0));
          places.push_back(lamp);
        }
      }
    }
  }
  for (size_t n = places.size(); n > 1; --n) std::swap(places[n - 1], places[random.Below(static_cast<uint32_t>(n))]);
  for (Lamp& lamp : places) {
    if (contents_.lamps.size() == static_cast<size_t>(plan.lamps)) break;
    lamp.height_m = random.Uniform(6.0, 8.0);
    const bool free = std::all_of(contents_.trees.begin(), contents_.trees.end(),
                                  [&](const Tree& tree) { return (tree.position - lamp.position).norm() > kFromTrunk_m; }) &&
                      std::all_of(contents_.parked.begin(), contents_.parked.end(),
                                  [&](const Car& car) { return car.kind == CarKind::kCar || DistanceToTruck(car, lamp.position) > kFromTruck_m; }) &&
                      (!contents_.bridge || contents_.bridge->DistanceTo(lamp.position) > kFromTruck_m);
    if (free) contents_.lamps.push_back(lamp);
  }
}

std::vector<Walker> CityLayout::MakeWalkers(int count, const Vector2d& min, const Vector2d& max, base::Random& random) const {
  std::vector<Walker> walkers;
  for (int k = 0; k < count; ++k) {
    const bool along_x = k % 2 == 0;
    const std::vector<Lane> lanes = LanesAcross(along_x ? 1 : 0, min, max);
    const Lane& lane = lanes[random.Below(static_cast<uint32_t>(lanes.size()))];
    const bool forward = random.UniformDouble() < 0.5;
    const double side = random.UniformDouble() < 0.5 ? -1.0 : 1.0;
    const double line = lane.line + side * (static_cast<double>(kRoadHalfWidth) + random.Uniform(0.4, static_cast<double>(kPavementWidth) - 0.3));
    const double sign = forward ? 1.0 : -1.0, from = forward ? lane.from : lane.to;
    Walker walker;
    walker.direction = turn_.TurnedDirection(along_x ? Vector2d(sign, 0.0) : Vector2d(0.0, sign));
    walker.start = turn_.Turned(along_x ? Vector2d(from, line) : Vector2d(line, from));
    walker.way_m = lane.to - lane.from;
    walker.offset_m = random.UniformDouble() * walker.way_m;
    walker.speed_mps = random.Uniform(1.0, 1.8);
    walker.seed = random.NextU32();
    walkers.push_back(walker);
  }
  return walkers;
}

}  // namespace skyquilt::simulate
