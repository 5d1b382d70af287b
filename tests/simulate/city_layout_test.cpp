#include "simulate/city_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

PlaceSpec Resolve(const std::string& name, int seed, double city_yaw_deg = -1.0, double district_turn_deg = -1.0) {
  SimulateOptions options;
  options.place = name;
  options.seed = seed;
  options.city_yaw_deg = city_yaw_deg;
  options.district_turn_deg = district_turn_deg;
  return ResolvePlace(options);
}

Vector2d GroundMin(const PlaceSpec& place) {
  return place.area_min - Vector2d::Constant(place.surround_m);
}
Vector2d GroundMax(const PlaceSpec& place) {
  return place.area_max + Vector2d::Constant(place.surround_m);
}

CityLayout Layout(const PlaceSpec& place) {
  return {place.city, GroundMin(place), GroundMax(place), place.seed};
}

GroundSample SampleAt(const CityLayout& layout, const Vector2d& at) {
  return layout.Sample(static_cast<float>(at.x()), static_cast<float>(at.y()));
}

// Towns of several seeds, directions of every quadrant, and one of each other place.
std::vector<PlaceSpec> Places() {
  std::vector<PlaceSpec> places;
  for (int seed = 1; seed <= 6; ++seed) places.push_back(Resolve("town", seed));
  for (const double yaw_deg : {0.0, 45.0, 120.0, 200.0, 290.0}) places.push_back(Resolve("town", 3, yaw_deg, 12.0));
  for (int seed = 1; seed <= 6; ++seed) places.push_back(Resolve("hamlet", seed));
  places.push_back(Resolve("smallcity", 2));
  return places;
}

std::string Name(const PlaceSpec& place) {
  return place.name + " " + std::to_string(place.seed) + ", yaw " + std::to_string(place.city.yaw_deg) + ", turn " +
         std::to_string(place.city.district_turn_deg);
}

// Calls `each` with points on the walls of a building, at most half a metre apart.
void AlongWalls(const Building& b, const std::function<void(const Vector2d&)>& each) {
  const Vector2d u = b.Axis(), v(-u.y(), u.x());
  for (double s = -0.5; s <= 0.5; s += 1.0 / std::ceil(2.0 * b.length_m)) {
    for (const double side : {-0.5, 0.5}) {
      each(b.centre + s * b.length_m * u + side * b.width_m * v);
      each(b.centre + side * b.length_m * u + s * b.width_m * v);
    }
  }
}

double FromRightAngles(double deg) {
  return std::abs(std::remainder(deg, 90.0));
}

TEST(CityLayout, BuildingsStandInTwoDirections) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    const double first = place.city.yaw_deg, second = first + place.city.district_turn_deg;
    int n_first = 0, n_second = 0;
    for (const Building& b : layout.contents().buildings) {
      const double to_first = FromRightAngles(b.yaw_deg - first), to_second = FromRightAngles(b.yaw_deg - second);
      EXPECT_LE(std::min(to_first, to_second), 8.0);  // sheds, houses at most 4
      EXPECT_LE(std::abs(b.yaw_deg), 180.0);
      (to_first < to_second ? n_first : n_second) += 1;
    }
    const auto n = static_cast<int>(layout.contents().buildings.size());
    EXPECT_GT(n_first, n / 8) << Name(place);
    EXPECT_GT(n_second, n / 8) << Name(place);
  }
}

TEST(CityLayout, BuildingsKeepOffTheStreets) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    int n_in_street = 0;
    for (const Building& b : layout.contents().buildings) {
      AlongWalls(b, [&](const Vector2d& at) {
        const GroundKind kind = SampleAt(layout, at).kind;
        if (kind == GroundKind::kRoad || kind == GroundKind::kPavement || kind == GroundKind::kField) ++n_in_street;
      });
    }
    EXPECT_EQ(n_in_street, 0) << Name(place);
  }
}

TEST(CityLayout, BuildingsKeepClearOfEachOther) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    const std::vector<Building>& buildings = layout.contents().buildings;
    double nearest = 1e9;
    for (const Building& b : buildings) {
      for (const Building& other : buildings) {
        if (&other == &b || (other.centre - b.centre).norm() > 60.0) continue;
        AlongWalls(b, [&](const Vector2d& at) { nearest = std::min(nearest, other.DistanceTo(at)); });
      }
    }
    EXPECT_GT(nearest, 0.3) << Name(place);
  }
}

TEST(CityLayout, CarsStandOnRoadsOrPavedGroundInTheirDirection) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    int n_beside = 0, n_in_building = 0, n_askew = 0;
    for (const Car& car : layout.contents().parked) {
      const GroundKind kind = SampleAt(layout, car.position).kind;
      if (kind != GroundKind::kRoad && kind != GroundKind::kPad) ++n_beside;
      const double turn = kind == GroundKind::kRoad ? 0.0 : place.city.district_turn_deg;
      if (std::min(FromRightAngles(car.yaw_deg - place.city.yaw_deg), FromRightAngles(car.yaw_deg - place.city.yaw_deg - turn)) > 3.0) ++n_askew;
      for (const Building& b : layout.contents().buildings) n_in_building += b.DistanceTo(car.position) < 0.9 ? 1 : 0;
    }
    EXPECT_GT(layout.contents().parked.size(), 3U);
    EXPECT_EQ(n_beside, 0) << Name(place);
    EXPECT_EQ(n_askew, 0) << Name(place);
    EXPECT_EQ(n_in_building, 0) << Name(place);
  }
}

TEST(CityLayout, MovingCarsStayOnRoadsInsideTheirRectangle) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    const Vector2d beyond = Vector2d::Constant(40.0);
    base::Random random(9);
    for (const MovingCar& car : layout.MakeMovingCars(8, place.area_min - beyond, place.area_max + beyond, random)) {
      EXPECT_GT(car.lane_length_m, 60.0) << Name(place);
      for (double time_s = 0.0; time_s < 60.0; time_s += 1.7) {
        const Vector2d at = car.At(time_s).position;
        EXPECT_EQ(SampleAt(layout, at).kind, GroundKind::kRoad) << Name(place);
        // The lane is beside the centre line, so the car may pass a corner of the rectangle by as much.
        EXPECT_GT((at - place.area_min + beyond).minCoeff(), -2.0) << Name(place);
        EXPECT_GT((place.area_max + beyond - at).minCoeff(), -2.0) << Name(place);
      }
    }
  }
}

TEST(CityLayout, TheSurveyedAreaIsBuiltUp) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    int n_field = 0;
    for (double x = place.area_min.x(); x <= place.area_max.x(); x += 5.0) {
      for (double y = place.area_min.y(); y <= place.area_max.y(); y += 5.0) {
        const GroundSample ground = SampleAt(layout, {x, y});
        if (ground.kind == GroundKind::kField || (ground.cell != nullptr && ground.cell->kind == CellKind::kField)) ++n_field;
      }
    }
    EXPECT_EQ(n_field, 0) << Name(place);
  }
}

TEST(CityLayout, NothingStandsBeyondTheGround) {
  for (const PlaceSpec& place : Places()) {
    const CityLayout layout = Layout(place);
    const auto past = [&](const Vector2d& at) { return std::max((GroundMin(place) - at).maxCoeff(), (at - GroundMax(place)).maxCoeff()); };
    for (const Building& b : layout.contents().buildings) AlongWalls(b, [&](const Vector2d& at) { EXPECT_LT(past(at), 0.0) << Name(place); });
    for (const Tree& tree : layout.contents().trees) EXPECT_LT(past(tree.position), 7.0);
    for (const Car& car : layout.contents().parked) EXPECT_LT(past(car.position), 7.0);
  }
}

TEST(CityLayout, StreetsHaveTheDirectionOfTheCity) {
  const PlaceSpec place = Resolve("town", 1, 30.0, 0.0);
  const CityLayout layout = Layout(place);
  const Vector2d along(std::cos(M_PI / 6.0), std::sin(M_PI / 6.0)), across(-along.y(), along.x());
  const Vector2d crossing = place.city.phase.x() * along + place.city.phase.y() * across;
  EXPECT_TRUE(SampleAt(layout, crossing).crossing);
  for (double s = 6.0; s < 60.0; s += 4.0) {
    const GroundSample on = SampleAt(layout, crossing + s * along + 2.0 * across);
    EXPECT_EQ(on.kind, GroundKind::kRoad);
    EXPECT_NEAR(on.across, 2.0F, 1e-3F);
    EXPECT_NEAR(on.along, static_cast<float>(place.city.phase.x() + s), 1e-3F);
    EXPECT_NE(SampleAt(layout, crossing + s * along + 5.0 * across).kind, GroundKind::kRoad);
  }
}

TEST(CityLayout, SeedsGiveDirectionsInAllQuarters) {
  std::set<int> quarters, eighths;
  for (int seed = 1; seed <= 40; ++seed) {
    const CityPlan city = Resolve("town", seed).city;
    EXPECT_GE(std::abs(city.district_turn_deg), 8.0);
    EXPECT_LE(std::abs(city.district_turn_deg), 12.0);
    quarters.insert(static_cast<int>(city.yaw_deg / 90.0));
    eighths.insert(static_cast<int>(std::fmod(city.yaw_deg, 90.0) / 11.25));
  }
  EXPECT_EQ(quarters, (std::set<int>{0, 1, 2, 3}));
  EXPECT_EQ(eighths.size(), 8U);
  EXPECT_EQ(Resolve("town", 7).city.yaw_deg, Resolve("smallcity", 7).city.yaw_deg);
  const CityPlan given = Resolve("town", 7, 0.0, 0.0).city;
  EXPECT_EQ(given.yaw_deg, 0.0);
  EXPECT_EQ(given.district_turn_deg, 0.0);
}

}  // namespace
}  // namespace skyquilt::simulate
