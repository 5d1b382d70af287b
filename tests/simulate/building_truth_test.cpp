#include "simulate/building_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "core/base/file.h"
#include "simulate/outline.h"
#include "simulate/roof_overhangs.h"
#include "simulate/world.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Json = nlohmann::json;

// Two towns and what is written about them.
class BuildingTruth : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    SimulateOptions options;
    options.seed = 3;
    options.building_shapes = GetParam();
    options.hillside_deg = 4.0;
    place_ = ResolvePlace(options);
    place_.city.tree_detail = 0;
    place_.ambient_voxel_m = 24.0;
    base::ThreadPool threads(2);
    world_ = std::make_unique<World>(place_, 1.0, threads);
    const TemporaryFolder folder;
    std::filesystem::create_directories(folder.path() / "truth");
    WriteBuildingTruth(folder.path(), world_->buildings(), place_, geo::EnuFrame({47.0, 8.0, 400.0}));
    truth_ = Json::parse(base::ReadFile(folder.path() / "truth/buildings.json"));
  }
  bool IsVaried() const { return std::string(GetParam()) == "varied"; }

  static Vector2d Point(const Json& json) { return {json.at(0).get<double>(), json.at(1).get<double>()}; }
  static Ring RingOf(const Json& json) {
    Ring ring;
    for (const Json& point : json) ring.push_back(Point(point));
    return ring;
  }
  static std::set<std::string> Keys(const Json& json) {
    std::set<std::string> keys;
    for (const auto& item : json.items()) keys.insert(item.key());
    return keys;
  }

  PlaceSpec place_;
  std::unique_ptr<World> world_;
  Json truth_;
};

TEST_P(BuildingTruth, HasAllKeys) {
  const std::set<std::string> of_parts = {
      "id",          "kind",     "roof",     "longitude_deg", "latitude_deg",   "east_m",         "north_m",
      "ground_z_m",  "length_m", "width_m",  "eave_height_m", "yaw_deg",        "ridge_height_m", "parapet_height_m",
      "inside_area", "building", "base_z_m", "carries",       "roof_overhang_m"};
  const std::set<std::string> of_outlines = {"id",         "shape",         "kind",           "roof",     "parts",   "walls",
                                             "holes",      "roof_outline",  "centre",         "length_m", "width_m", "yaw_deg",
                                             "ground_z_m", "eave_height_m", "ridge_height_m", "area_m2",  "planes",  "inside_area"};
  ASSERT_GT(truth_["buildings"].size(), 60U);
  for (const Json& part : truth_["buildings"]) EXPECT_EQ(Keys(part), of_parts);
  for (const Json& outline : truth_["outlines"]) {
    EXPECT_EQ(Keys(outline), of_outlines);
    for (const Json& plane : outline["planes"]) EXPECT_EQ(Keys(plane), (std::set<std::string>{"part", "normal", "offset"}));
  }
}

TEST_P(BuildingTruth, PartsAndOutlinesNameEachOther) {
  const Json& parts = truth_["buildings"];
  std::vector<int> named(parts.size(), 0);
  int n_inside = 0;
  for (size_t i = 0; i < truth_["outlines"].size(); ++i) {
    const Json& outline = truth_["outlines"][i];
    EXPECT_EQ(outline["id"], i);
    double largest_m2 = 0.0, eave_m = 0.0, ridge_m = 0.0;
    for (const size_t row : outline["parts"]) {
      const Json& part = parts[row];
      ++named[row];
      EXPECT_EQ(part["id"], row);
      EXPECT_EQ(part["building"], outline["id"]);
      EXPECT_EQ(part["ground_z_m"], outline["ground_z_m"]);
      const double area_m2 = part["length_m"].get<double>() * part["width_m"].get<double>();
      if (area_m2 > largest_m2) {
        largest_m2 = area_m2;
        eave_m = part["eave_height_m"];
        EXPECT_EQ(part["base_z_m"], part["ground_z_m"]);
      }
      ridge_m = std::max(ridge_m, part["ridge_height_m"].get<double>());
    }
    EXPECT_EQ(outline["eave_height_m"], eave_m);
    EXPECT_EQ(outline["ridge_height_m"], ridge_m);
    EXPECT_EQ(outline["parts"].size() == 1, outline["shape"] == "rectangle");
    double area_m2 = SignedArea(RingOf(outline["walls"]));
    EXPECT_GT(area_m2, 0.0);
    for (const Json& hole : outline["holes"]) area_m2 += SignedArea(RingOf(hole));
    EXPECT_NEAR(outline["area_m2"].get<double>(), area_m2, 1e-6);
    bool inside = true;
    for (const Vector2d& corner : RingOf(outline["walls"])) {
      inside = inside && (corner - place_.area_min).minCoeff() >= 0.0 && (place_.area_max - corner).minCoeff() >= 0.0;
    }
    EXPECT_EQ(outline["inside_area"], inside);
    n_inside += inside ? 1 : 0;
    for (const size_t row : outline["parts"]) EXPECT_TRUE(!inside || parts[row]["inside_area"].get<bool>());
  }
  EXPECT_EQ(std::count(named.begin(), named.end(), 1), static_cast<std::ptrdiff_t>(parts.size()));
  EXPECT_GT(n_inside, 15);
  EXPECT_EQ(truth_["outlines"].size() < parts.size(), IsVaried());
}

TEST_P(BuildingTruth, RoofOutlinesReachBeyondWallsByTheOverhang) {
  std::set<double> overhangs;
  for (const Json& outline : truth_["outlines"]) {
    const Json& part = truth_["buildings"][outline["parts"][0].get<size_t>()];
    const double overhang_m = part["roof_overhang_m"];
    EXPECT_EQ(part["roof"] == "flat", overhang_m == 0.0);
    overhangs.insert(overhang_m);
    if (outline["shape"] != "rectangle") continue;
    const double length_m = part["length_m"].get<double>() + 2.0 * overhang_m, width_m = part["width_m"].get<double>() + 2.0 * overhang_m;
    EXPECT_NEAR(SignedArea(RingOf(outline["roof_outline"])), length_m * width_m, 1e-6);
  }
  EXPECT_EQ(overhangs.size() > 2, IsVaried());
}

TEST_P(BuildingTruth, DecksUnderOtherPartsSayWhatTheyCarry) {
  int n_carrying = 0;
  for (const Json& part : truth_["buildings"]) {
    for (const size_t row : part["carries"]) {
      ++n_carrying;
      const Json& upper = truth_["buildings"][row];
      EXPECT_EQ(upper["building"], part["building"]);
      EXPECT_NEAR(upper["base_z_m"].get<double>(), part["ground_z_m"].get<double>() + part["eave_height_m"].get<double>(), 1e-9);
    }
  }
  EXPECT_EQ(n_carrying > 0, IsVaried());
}

// Rays from above meet every roof at the height of the planes that the truth has for it, and nothing higher but what stands on roofs.
TEST_P(BuildingTruth, RaysFromAboveMeetTheRoofs) {
  const std::vector<Building>& buildings = world_->buildings();
  std::map<BuildingShape, std::array<int, 2>> agree;  // rays, and those that do
  for (const Json& outline : truth_["outlines"]) {
    std::map<size_t, std::vector<RoofPlane3d>> planes;
    for (const Json& plane : outline["planes"]) {
      const Json& n = plane["normal"];
      planes[plane["part"]].push_back({{n[0].get<double>(), n[1].get<double>(), n[2].get<double>()}, plane["offset"].get<double>()});
    }
    const size_t first = outline["parts"][0];
    for (const auto& [row, of_part] : planes) {
      const Building& part = buildings[row];
      const Vector2d u = part.Axis(), v(-u.y(), u.x());
      for (const double x : {-0.8, -0.31, 0.02, 0.37, 0.8}) {
        for (const double y : {-0.7, -0.2, 0.03, 0.35, 0.7}) {
          const Vector2d at = part.centre + 0.5 * x * part.length_m * u + 0.5 * y * part.width_m * v;
          double expected = -1e9;
          bool near_edge = false;
          for (const size_t other : outline["parts"]) {
            const double distance = buildings[other].DistanceTo(at);
            near_edge = near_edge || std::abs(distance) < kLargestOverhang_m + 0.05;
            if (distance > 0.0) continue;
            double height = 1e9;
            for (const RoofPlane3d& plane : planes[other]) height = std::min(height, plane.HeightAt(at));
            expected = std::max(expected, height);
          }
          if (near_edge) continue;
          raytrace::RayPacket ray{};
          ray.Set(0, {static_cast<float>(at.x()), static_cast<float>(at.y()), 300.0F}, -Eigen::Vector3f::UnitZ(), 0.0F, 1e4F);
          world_->scene().Intersect(ray);
          ASSERT_NE(ray.triangle[0], raytrace::kNoTriangle);
          const Tag tag = world_->mesh().tag[ray.triangle[0]];
          const double z = 300.0 - static_cast<double>(ray.t_far[0]);
          ASSERT_GT(z, expected - 1e-3) << "row " << row;
          if (tag.part != Part::kFlatRoof && tag.part != Part::kPitchedRoof) continue;  // a chimney, a machine, or a tree
          std::array<int, 2>& count = agree[part.shape];
          ++count[0];
          // Of a wing whose roof runs on, the main part's wall is below the wing's roof.
          const bool run_on = z > expected + 1e-3 && buildings[tag.object].onto_rise > 0.0 && tag.object != row;
          if (std::abs(z - expected) < 2e-3 || run_on) ++count[1];
          ASSERT_EQ(buildings[tag.object].outline, buildings[first].outline);
        }
      }
    }
  }
  for (const auto& [shape, count] : agree) {
    EXPECT_EQ(count[1], count[0]) << ShapeName(shape);
    EXPECT_GT(count[0], 20) << ShapeName(shape);
  }
  EXPECT_EQ(agree.size(), IsVaried() ? 6U : 1U);
}

TEST_P(BuildingTruth, WallsReachTheGround) {
  for (const Building& b : world_->buildings()) {
    if (b.base_height_m > 0.0) continue;
    const Vector2d u = b.Axis(), v(-u.y(), u.x());
    for (const double x : {-0.5, 0.0, 0.5}) {
      for (const double y : {-0.5, 0.0, 0.5}) {
        const Eigen::Vector2f at = (b.centre + x * b.length_m * u + y * b.width_m * v).cast<float>();
        EXPECT_LT(b.ground_z_m - b.foundation_m, static_cast<double>(world_->terrain().Height(at.x(), at.y())));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, BuildingTruth, testing::Values("plain", "varied"),
                         [](const auto& param_info) { return std::string(param_info.param); });

}  // namespace
}  // namespace skyquilt::simulate
