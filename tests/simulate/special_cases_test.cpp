// Bridges, trucks and places without buildings: what a search for buildings must not take for one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/survey/surface_class.h"
#include "simulate/building_truth.h"
#include "simulate/flight.h"
#include "simulate/photo_renderer.h"
#include "simulate/world.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using survey::SurfaceClass;

using Change = std::function<void(SimulateOptions&)>;

PlaceSpec PlaceWith(const Change& change, const std::string& name = "town", int seed = 1) {
  SimulateOptions options;
  options.place = name;
  options.seed = seed;
  change(options);
  PlaceSpec place = ResolvePlace(options);
  place.city.tree_detail = 0;
  place.ambient_voxel_m = 24.0;
  return place;
}

CityLayout LayoutOf(const PlaceSpec& place) {
  const Vector2d surround = Vector2d::Constant(place.surround_m);
  return {place.city, place.area_min - surround, place.area_max + surround, place.seed};
}

std::vector<Car> TrucksOf(const CityContents& contents) {
  std::vector<Car> trucks;
  std::copy_if(contents.parked.begin(), contents.parked.end(), std::back_inserter(trucks), [](const Car& car) { return car.kind != CarKind::kCar; });
  return trucks;
}

double DistanceTo(const Car& truck, const Vector2d& at) {
  const Vector2d local = PlaneTurn(truck.position, truck.yaw_deg).TurnedBack(at) - truck.position;
  return DistanceToRectangle(local, {0.5 * kTruckLength_m, 0.5 * kTruckWidth_m});
}

void ExpectSameBuildings(const CityContents& a, const CityContents& b) {
  ASSERT_EQ(a.buildings.size(), b.buildings.size());
  for (size_t i = 0; i < a.buildings.size(); ++i) {
    EXPECT_EQ(a.buildings[i].centre, b.buildings[i].centre);
    EXPECT_EQ(a.buildings[i].seed, b.buildings[i].seed);
    EXPECT_EQ(a.buildings[i].ridge_height_m, b.buildings[i].ridge_height_m);
  }
}

// A town with a bridge, trucks and much traffic.
class BusyTown : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    threads_ = new base::ThreadPool(2);
    place_ = new PlaceSpec(PlaceWith([](SimulateOptions& o) {
      o.bridge = true;
      o.trucks = 8;
      o.moving_cars = 20;
    }));
    world_ = new World(*place_, 1.0, *threads_);
  }
  static void TearDownTestSuite() {
    delete world_;
    delete place_;
    delete threads_;
  }
  static const Bridge& TheBridge() { return *world_->city()->contents().bridge; }
  static Vector2d OnBridge(double along, double across) {
    return TheBridge().centre + PlaneTurn(Vector2d::Zero(), TheBridge().yaw_deg).TurnedDirection({along, across});
  }
  static double Ground(const Vector2d& at) {
    return static_cast<double>(world_->terrain().Height(static_cast<float>(at.x()), static_cast<float>(at.y())));
  }
  static raytrace::RayPacket Trace(const Vector3d& from, const Vector3d& direction, float far_m = 1e4F) {
    raytrace::RayPacket ray{};
    ray.Set(0, from.cast<float>(), direction.cast<float>(), 0.0F, far_m);
    world_->scene().Intersect(ray);
    return ray;
  }
  struct Top {
    double z_m = 0.0;
    Part part = Part::kGround;
  };
  static Top TopAt(const Vector2d& at) {
    const raytrace::RayPacket ray = Trace({at.x(), at.y(), 200.0}, -Vector3d::UnitZ());
    return {200.0 - static_cast<double>(ray.t_far[0]), world_->mesh().tag[ray.triangle[0]].part};
  }
  // Depth and class in the middle of a photo from straight above.
  static std::pair<double, SurfaceClass> SeenFromAbove(const Vector3d& camera_at) {
    const camera::Camera camera{camera::CameraModel::kSimplePinhole, 9, 9, {60.0, 4.5, 4.5}};
    MovingScene nothing{{}, {}, {}, raytrace::TracedScene({}, {})};
    const SurfaceImages seen = PhotoRenderer(*world_, camera, 1, false).Surfaces(PoseFromGimbal(camera_at, 0.0, -90.0, 0.0), nothing, *threads_);
    return {static_cast<double>(*seen.z_depth.At(4, 4)), static_cast<SurfaceClass>(*seen.classes.At(4, 4))};
  }

  static inline base::ThreadPool* threads_ = nullptr;
  static inline PlaceSpec* place_ = nullptr;
  static inline World* world_ = nullptr;
};

TEST_F(BusyTown, HasTheBuildingsOfTheTownWithoutThem) {
  const World usual(PlaceWith([](SimulateOptions&) {}), 1.0, *threads_);
  ExpectSameBuildings(world_->city()->contents(), usual.city()->contents());
}

TEST_F(BusyTown, BridgeHasALevelDeckWithRoomBelow) {
  const double deck_z_m = TopAt(TheBridge().centre).z_m;
  EXPECT_GT(deck_z_m - Ground(TheBridge().centre), 4.99);
  EXPECT_LT(deck_z_m - Ground(TheBridge().centre), 6.01);
  for (double along = -14.9; along < 15.0; along += 1.3) {
    for (const double across : {-3.5, 0.1, 3.5}) {
      const Top top = TopAt(OnBridge(along, across));
      EXPECT_EQ(top.part, Part::kBridgeRoad);
      EXPECT_NEAR(top.z_m, deck_z_m, 1e-3);
    }
  }
  // Along the street below.
  const Vector2d from = OnBridge(0.5, -9.0), to = OnBridge(0.5, 9.0);
  const Vector3d direction(to.x() - from.x(), to.y() - from.y(), 0.0);
  EXPECT_EQ(Trace({from.x(), from.y(), Ground(TheBridge().centre) + 2.0}, direction.normalized(), 18.0F).triangle[0], raytrace::kNoTriangle);
  // Abutments and piers are in the way along the street above.
  const Vector2d ahead = OnBridge(1.0, 0.0) - TheBridge().centre;
  for (const double side : {-1.0, 1.0}) {
    const raytrace::RayPacket ray =
        Trace({TheBridge().centre.x(), TheBridge().centre.y(), deck_z_m - 2.0}, side * Vector3d(ahead.x(), ahead.y(), 0.0), 20.0F);
    ASSERT_NE(ray.triangle[0], raytrace::kNoTriangle);
    EXPECT_EQ(world_->mesh().tag[ray.triangle[0]].part, Part::kBridgeConcrete);
    EXPECT_NEAR(static_cast<double>(ray.t_far[0]), 8.5, 1e-3);
  }
}

TEST_F(BusyTown, RampsLeadFromTheStreetToTheDeck) {
  constexpr double kFoot_m = 0.5 * kDeckLength_m + kRampLength_m;
  for (const double side : {-1.0, 1.0}) {
    const Vector2d foot = OnBridge(side * (kFoot_m - 0.01), 0.0);
    EXPECT_LT(TopAt(foot).z_m - Ground(foot), 0.2);
    EXPECT_EQ(TopAt(OnBridge(side * (kFoot_m + 0.5), 0.0)).part, Part::kGround);
    for (double along = 0.5 * kDeckLength_m; along < kFoot_m - 1.0; along += 1.0) {
      for (const double across : {-3.5, 0.0, 3.5}) {
        const Top upper = TopAt(OnBridge(side * along, across)), lower = TopAt(OnBridge(side * (along + 0.9), across));
        EXPECT_EQ(lower.part, Part::kBridgeRoad);
        EXPECT_LT(std::abs(upper.z_m - lower.z_m), 0.25 * 0.9);
      }
    }
  }
}

// Faces look outwards: whatever a ray from outside meets first is turned towards it.
TEST_F(BusyTown, BridgeFacesLookOutwards) {
  const Vector3d middle(TheBridge().centre.x(), TheBridge().centre.y(), TopAt(TheBridge().centre).z_m);
  int n_hit = 0;
  for (double azimuth = 0.05; azimuth < 6.28; azimuth += 0.21) {
    for (const double up : {-0.03, 0.02, 0.2, 0.9}) {
      for (double along = -46.0; along <= 46.0; along += 4.1) {
        const Vector2d at = OnBridge(along, 0.4);
        const Vector3d target(at.x(), at.y(), middle.z() - 0.6);
        const Vector3d direction = Vector3d(std::cos(azimuth), std::sin(azimuth), -up).normalized();
        const raytrace::RayPacket ray = Trace(target - 12.0 * direction, direction);
        if (ray.triangle[0] == raytrace::kNoTriangle) continue;
        const Part part = world_->mesh().tag[ray.triangle[0]].part;
        if (part != Part::kBridgeRoad && part != Part::kBridgeConcrete) continue;
        // Twelve metres away along the street is on the bridge, or in a ramp.
        if (TheBridge().DistanceTo((target - 12.0 * direction).head<2>()) < 0.5) continue;
        ++n_hit;
        EXPECT_LT(world_->mesh().FaceNormal(ray.triangle[0]).dot(direction.cast<float>()), 0.0F);
      }
    }
  }
  EXPECT_GT(n_hit, 500);
}

TEST_F(BusyTown, DepthAndClassesShowBridgeAndTrucks) {
  const double deck_z_m = TopAt(TheBridge().centre).z_m;
  const auto [to_deck, deck] = SeenFromAbove({TheBridge().centre.x(), TheBridge().centre.y(), deck_z_m + 50.0});
  EXPECT_NEAR(to_deck, 50.0, 1e-3);
  EXPECT_EQ(deck, SurfaceClass::kRoad);
  for (const Car& truck : TrucksOf(world_->city()->contents())) {
    // Not above the cab.
    const Vector2d at = truck.position - PlaneTurn(Vector2d::Zero(), truck.yaw_deg).TurnedDirection({1.0, 0.0});
    const auto [to_top, top] = SeenFromAbove({at.x(), at.y(), truck.ground_z_m + kTruckHeight_m + 50.0});
    EXPECT_NEAR(to_top, 50.0, 1e-3);
    EXPECT_EQ(top, SurfaceClass::kParkedCar);
  }
}

TEST_F(BusyTown, TrucksStandInStreetsAndTouchNothing) {
  const CityContents& contents = world_->city()->contents();
  const std::vector<Car> trucks = TrucksOf(contents);
  ASSERT_EQ(trucks.size(), 8U);
  for (const Car& truck : trucks) {
    const GroundSample ground = world_->city()->Sample(static_cast<float>(truck.position.x()), static_cast<float>(truck.position.y()));
    EXPECT_EQ(ground.kind, GroundKind::kRoad);
    EXPECT_GT(TheBridge().DistanceTo(truck.position), 4.0);
    for (const Building& b : contents.buildings) EXPECT_GT(b.DistanceTo(truck.position), 5.0);
    for (const Car& other : contents.parked) {
      if (other.position == truck.position) continue;
      EXPECT_GT(DistanceTo(truck, other.position), other.kind == CarKind::kCar ? 2.5 : 4.0);
    }
    for (size_t i = 0; i < contents.trees.size(); ++i) {
      if (DistanceTo(truck, contents.trees[i].position) > 10.0) continue;
      Mesh crown;
      AddTree(contents.trees[i], 0, 0, crown);
      for (const Eigen::Vector3f& vertex : crown.position) EXPECT_GT(DistanceTo(truck, vertex.head<2>().cast<double>()), 0.0);
    }
    Mesh mesh;
    AddCar(truck, 0, mesh);
    double highest = 0.0;
    Vector2d half = Vector2d::Zero();
    for (const Eigen::Vector3f& vertex : mesh.position) {
      const Vector2d local = PlaneTurn(truck.position, truck.yaw_deg).TurnedBack(vertex.head<2>().cast<double>()) - truck.position;
      half = half.cwiseMax(local.cwiseAbs());
      highest = std::max(highest, static_cast<double>(vertex.z()) - truck.ground_z_m);
    }
    EXPECT_NEAR(highest, kTruckHeight_m, 1e-4);
    EXPECT_NEAR(half.x(), 0.5 * kTruckLength_m, 1e-4);
    EXPECT_NEAR(half.y(), 0.5 * kTruckWidth_m, 1e-4);
  }
  EXPECT_TRUE(std::any_of(trucks.begin(), trucks.end(), [](const Car& car) { return car.kind == CarKind::kTruck; }));
  EXPECT_TRUE(std::any_of(trucks.begin(), trucks.end(), [](const Car& car) { return car.kind == CarKind::kContainer; }));
}

TEST_F(BusyTown, NothingElseStandsOnTheBridge) {
  const CityContents& contents = world_->city()->contents();
  for (const Building& b : contents.buildings) {
    for (double along = -48.0; along <= 48.0; along += 2.0) EXPECT_GT(b.DistanceTo(OnBridge(along, 0.0)), 4.5);
  }
  for (const Car& car : contents.parked) EXPECT_GT(TheBridge().DistanceTo(car.position), 2.0);
  for (const Tree& tree : contents.trees) {
    if (TheBridge().DistanceTo(tree.position) > 10.0) continue;
    Mesh crown;
    AddTree(tree, 0, 0, crown);
    for (const Eigen::Vector3f& vertex : crown.position) EXPECT_GT(TheBridge().DistanceTo(vertex.head<2>().cast<double>()), 0.0);
  }
}

// Cars drive past trucks, and over the bridge or below it, never through it.
TEST_F(BusyTown, TrafficStaysOnItsRoad) {
  const std::vector<Car> trucks = TrucksOf(world_->city()->contents());
  int n_over = 0, n_below = 0;
  for (double time_s = 0.0; time_s < 90.0; time_s += 0.7) {
    for (const Car& car : world_->MovingAt(time_s).cars) {
      for (const Car& truck : trucks) EXPECT_GT(DistanceTo(truck, car.position), 1.0);
      if (TheBridge().DistanceTo(car.position) > -0.3) continue;
      const double top_m = TopAt(car.position).z_m;
      const bool along = std::abs(std::cos((car.yaw_deg - TheBridge().yaw_deg) * M_PI / 180.0)) > 0.7;
      if (along) {
        ++n_over;
        EXPECT_NEAR(car.ground_z_m, top_m, 2e-3);
      } else {
        ++n_below;
        EXPECT_NEAR(car.ground_z_m, Ground(car.position), 1e-6);
        EXPECT_GT(top_m - car.ground_z_m, 4.0);
      }
    }
  }
  EXPECT_GT(n_over, 10);
  EXPECT_GT(n_below, 3);
}

TEST(SpecialCases, EveryPlaceHasRoomForABridgeAndTrucks) {
  for (const char* name : {"hamlet", "town", "smallcity"}) {
    for (int seed = 1; seed <= (std::string(name) == "smallcity" ? 1 : 3); ++seed) {
      const PlaceSpec place = PlaceWith(
          [](SimulateOptions& o) {
            o.bridge = true;
            o.trucks = 3;
            o.building_shapes = "varied";
          },
          name, seed);
      const CityLayout layout = LayoutOf(place);
      const Bridge& bridge = *layout.contents().bridge;
      EXPECT_EQ(TrucksOf(layout.contents()).size(), 3U) << name;
      EXPECT_LT((bridge.centre - 0.5 * (place.area_min + place.area_max)).norm(), place.city.pitch_m);
      const PlaneTurn turn(Vector2d::Zero(), bridge.yaw_deg);
      for (double along = -48.0; along <= 48.0; along += 3.0) {
        for (const double across : {-3.9, 0.0, 3.9}) {
          const Eigen::Vector2f at = (bridge.centre + turn.TurnedDirection({along, across})).cast<float>();
          EXPECT_EQ(layout.Sample(at.x(), at.y()).kind, GroundKind::kRoad) << name << " " << along;
        }
      }
    }
  }
}

TEST(SpecialCases, WithoutBuildingsTheTruthIsEmpty) {
  const PlaceSpec place = PlaceWith(
      [](SimulateOptions& o) {
        o.building_share = 0.0;
        o.tree_density = 2.0;
        o.building_shapes = "varied";
      },
      "hamlet", 2);
  base::ThreadPool threads(2);
  const World world(place, 1.0, threads);
  EXPECT_TRUE(world.buildings().empty());
  for (const Tag& tag : world.mesh().tag) {
    EXPECT_TRUE(tag.part == Part::kGround || tag.part == Part::kWater || tag.part == Part::kTrunk || tag.part == Part::kLeaves ||
                tag.part == Part::kCarBody || tag.part == Part::kCarGlass || tag.part == Part::kCarTyre);
  }
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "truth");
  WriteBuildingTruth(folder.path(), world.buildings(), place, geo::EnuFrame({47.0, 8.0, 400.0}));
  const auto truth = base::ParseJson(base::ReadFile(folder.path() / "truth/buildings.json"));
  EXPECT_EQ(truth["buildings"], nlohmann::json::array());
  EXPECT_EQ(truth["outlines"], nlohmann::json::array());
  // A wood: trees in the surveyed area as dense as crowns allow.
  int n_trees = 0;
  for (const Tree& tree : world.city()->contents().trees)
    n_trees += (tree.position - place.area_min).minCoeff() > 0.0 && (place.area_max - tree.position).minCoeff() > 0.0 ? 1 : 0;
  EXPECT_GT(n_trees, 60);
}

// Some cells become woods; what is on the others does not change.
TEST(SpecialCases, ASmallerShareKeepsSomeBuildingsAsTheyAre) {
  const CityLayout all = LayoutOf(PlaceWith([](SimulateOptions&) {}));
  size_t n_before = all.contents().buildings.size();
  for (const double share : {0.8, 0.5, 0.2}) {
    const CityLayout some = LayoutOf(PlaceWith([share](SimulateOptions& o) { o.building_share = share; }));
    EXPECT_LT(some.contents().buildings.size(), n_before);
    n_before = some.contents().buildings.size();
    EXPECT_GT(n_before, 0U);
    for (const Building& kept : some.contents().buildings) {
      EXPECT_TRUE(std::any_of(all.contents().buildings.begin(), all.contents().buildings.end(), [&](const Building& b) {
        return b.centre == kept.centre && b.seed == kept.seed && b.eave_height_m == kept.eave_height_m;
      }));
    }
  }
}

TEST(SpecialCases, TreeDensityIsAFactor) {
  const auto With = [](double density) { return LayoutOf(PlaceWith([density](SimulateOptions& o) { o.tree_density = density; })); };
  const CityLayout usual = With(1.0), none = With(0.0), half = With(0.5), triple = With(3.0);
  const auto n_usual = static_cast<double>(usual.contents().trees.size());
  EXPECT_EQ(none.contents().trees.size(), 0U);
  EXPECT_NEAR(static_cast<double>(half.contents().trees.size()), 0.5 * n_usual, 0.1 * n_usual);
  EXPECT_GT(static_cast<double>(triple.contents().trees.size()), 2.0 * n_usual);
  EXPECT_LT(static_cast<double>(triple.contents().trees.size()), 3.2 * n_usual);
  ExpectSameBuildings(usual.contents(), triple.contents());
  for (const Tree& tree : triple.contents().trees) {
    for (const Building& b : triple.contents().buildings) EXPECT_GT(b.DistanceTo(tree.position), tree.crown_radius_m);
  }
}

}  // namespace
}  // namespace skyquilt::simulate
