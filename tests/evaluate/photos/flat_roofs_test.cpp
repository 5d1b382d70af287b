#include "evaluate/photos/flat_roofs.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/survey/surface_class.h"
#include "tests/evaluate/photos/nadir_view.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::photos {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using survey::SurfaceClass;

constexpr int kViewWidth = 100, kViewHeight = 80;

// From 100 m above a deck of 30 m x 20 m at height 0, where a pixel is a metre; ground 10 m below around it. Rendered exactly.
struct Deck {
  HeldOutPhoto task;
  PhotoResult findings;
  RoofArea area{{0, 0}, {1, 0}, {14.0, 9.0}};

  Deck() {
    const TrainingView view = NadirView(0, 0, 100);
    task.camera = view.camera;
    task.cam_from_enu = view.cam_from_enu;
    findings.scored = image::Image8(kViewWidth, kViewHeight, 1, 1);
    findings.true_depth = image::ImageF(kViewWidth, kViewHeight, 1, 110.0F);
    findings.true_class = image::Image8(kViewWidth, kViewHeight, 1, static_cast<uint8_t>(SurfaceClass::kGround));
    findings.true_normals = image::ImageF(kViewWidth, kViewHeight, 3, 0.0F);
    for (int y = 0; y < kViewHeight; ++y) {
      for (int x = 0; x < kViewWidth; ++x) {
        findings.true_normals.At(x, y)[2] = 1.0F;
        if (std::abs(x + 0.5 - 50) > 15 || std::abs(y + 0.5 - 40) > 10) continue;
        *findings.true_depth.At(x, y) = 100.0F;
        *findings.true_class.At(x, y) = static_cast<uint8_t>(SurfaceClass::kRoof);
      }
    }
    findings.z_depth = findings.true_depth;
  }
  FlatRoofScore Score() const {
    FlatRoofPoints points({area});
    points.Add(task, findings);
    return points.Result();
  }
};

class FlatRoofs : public ::testing::Test, protected Deck {};

TEST_F(FlatRoofs, AnExactRoofIsFlat) {
  const FlatRoofScore score = Deck().Score();
  EXPECT_EQ(score.roofs, 1);
  EXPECT_NEAR(score.spread.rms_m, 0.0, 1e-5);
}

TEST_F(FlatRoofs, RoughnessIsMeasuredOnTheDeckOnly) {
  base::Random random(5);
  for (float& z : findings.z_depth.data) z += static_cast<float>(0.25 * random.Normal());
  for (int y = 0; y < kViewHeight; ++y) {
    for (int x = 0; x < kViewWidth; ++x) {
      const bool rim = std::abs(x + 0.5 - 50) > 14 || std::abs(y + 0.5 - 40) > 9;
      if (rim) *findings.z_depth.At(x, y) += 30.0F;  // parapets, walls and ground
      const bool box = x >= 40 && x < 44 && y >= 36 && y < 40;
      if (box) *findings.true_depth.At(x, y) -= 2.4F;  // a stair housing is a level roof too
      if (box) *findings.z_depth.At(x, y) -= 5.0F;
      const bool slope = x >= 55 && x < 57 && y >= 36 && y < 40;
      if (slope) findings.true_normals.At(x, y)[2] = 0.7F;
      if (slope) *findings.z_depth.At(x, y) += 5.0F;
    }
  }
  for (int x = 0; x < kViewWidth; ++x) {
    *findings.true_class.At(x, 45) = static_cast<uint8_t>(SurfaceClass::kTree);
    *findings.z_depth.At(x, 45) -= 9.0F;
    *findings.scored.At(x, 46) = 0;
    *findings.z_depth.At(x, 46) -= 9.0F;
  }
  const FlatRoofScore score = Score();
  EXPECT_EQ(score.roofs, 1);
  EXPECT_NEAR(score.spread.rms_m, 0.25, 0.02);
  EXPECT_NEAR(score.spread.nmad_m, 0.25, 0.02);
}

TEST_F(FlatRoofs, ATiltedPlaneIsFlatToo) {
  for (int y = 0; y < kViewHeight; ++y) {
    for (int x = 0; x < kViewWidth; ++x) {
      // On the plane z = 0.1 east: from 100 m up, the ray at x metres per 100 m of z-depth meets it where 100 - z_depth = 0.1 x z_depth / 100.
      *findings.z_depth.At(x, y) = static_cast<float>(100.0 / (1.0 + 0.1 * (x + 0.5 - 50) / 100.0));
    }
  }
  EXPECT_NEAR(Score().spread.rms_m, 0.0, 1e-4);
}

TEST_F(FlatRoofs, FewPixelsThatAreFarOffCountInTheRmsOnly) {
  for (int x = 47; x < 53; ++x) *findings.z_depth.At(x, 40) += 5.0F;  // 6 of 504, in the middle: the plane is not tilted
  const PlaneSpread spread = Score().spread;
  EXPECT_NEAR(spread.rms_m, 5.0 * std::sqrt(6.0 / 504.0), 0.05);
  EXPECT_LT(spread.nmad_m, 0.05);
}

TEST_F(FlatRoofs, FewPointsAreNotMeasured) {
  area.half_m = {3.4, 3.4};  // 36 pixels
  EXPECT_EQ(Score().roofs, 0);
  EXPECT_TRUE(std::isnan(Score().spread.rms_m));
  FlatRoofPoints two_photos({area});
  two_photos.Add(task, findings);
  two_photos.Add(task, findings);
  EXPECT_EQ(two_photos.Result().roofs, 1);
}

TEST_F(FlatRoofs, WithoutTruthThereAreNone) {
  findings.true_class = image::Image8();
  EXPECT_EQ(Score().roofs, 0);
}

TEST_F(FlatRoofs, AreasAreTheFootprintsWithoutTheRim) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "buildings.json";
  base::WriteFileAtomically(file, R"({"buildings": [
    {"roof": "gable", "yaw_deg": 0, "east_m": 0, "north_m": 0, "length_m": 10, "width_m": 8},
    {"roof": "flat", "yaw_deg": 90, "east_m": 100, "north_m": 50, "length_m": 12, "width_m": 8},
    {"roof": "flat", "yaw_deg": 0, "east_m": 0, "north_m": 0, "length_m": 3, "width_m": 1.9}]})");
  const std::vector<RoofArea> areas = ReadFlatRoofs(file);
  ASSERT_EQ(areas.size(), 1U);
  EXPECT_TRUE(areas[0].Contains({100.0, 54.9}));
  EXPECT_FALSE(areas[0].Contains({100.0, 55.1}));
  EXPECT_TRUE(areas[0].Contains({102.9, 50.0}));
  EXPECT_FALSE(areas[0].Contains({103.1, 50.0}));
  base::WriteFileAtomically(file, R"({"buildings": [{"roof": "flat"}]})");
  EXPECT_THROW(ReadFlatRoofs(file), base::InputError);
  base::WriteFileAtomically(file, "{");
  EXPECT_THROW(ReadFlatRoofs(file), base::InputError);
}

// The tower's deck is measured, not the podium's below it.
TEST_F(FlatRoofs, DecksUnderOtherPartsAreLeftOut) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "buildings.json";
  base::WriteFileAtomically(file, R"({"buildings": [
    {"roof": "flat", "yaw_deg": 0, "east_m": 0, "north_m": 0, "length_m": 24, "width_m": 18, "carries": [1]},
    {"roof": "flat", "yaw_deg": 0, "east_m": 1, "north_m": 0, "length_m": 16, "width_m": 12, "carries": []}]})");
  const std::vector<RoofArea> areas = ReadFlatRoofs(file);
  ASSERT_EQ(areas.size(), 1U);
  EXPECT_EQ(areas[0].centre.x(), 1.0);
}

TEST(SpreadAboutPlane, NeedsThreePointsAndSurvivesThoseOnALine) {
  const std::vector<Vector3d> points = {{0, 0, 5}, {1, 1, 6}, {2, 2, 7}};
  EXPECT_TRUE(std::isnan(SpreadAboutPlane(std::span(points).first(2)).rms_m));
  EXPECT_NEAR(SpreadAboutPlane(points).rms_m, 0.0, 1e-6);
  const std::vector<Vector3d> one_place = {{1, 1, 4}, {1, 1, 6}, {1, 1, 5}};
  EXPECT_NEAR(SpreadAboutPlane(one_place).rms_m, std::sqrt(2.0 / 3.0), 1e-12);
}

// Any plane may be added to points without making them rougher, and turning them about the vertical changes nothing.
RC_GTEST_PROP(SpreadAboutPlane, DoesNotDependOnThePlaneOrTheYaw, ()) {
  base::Random random(*rc::gen::arbitrary<uint32_t>());
  const double yaw = random.Uniform(0.0, 6.28);
  const Vector3d plane{random.Uniform(-2.0, 2.0), random.Uniform(-2.0, 2.0), random.Uniform(-500.0, 500.0)};
  std::vector<Vector3d> points, moved;
  const auto n = *rc::gen::inRange(3, 200);
  for (int i = 0; i < n; ++i) {
    const Vector3d p{random.Uniform(-10.0, 10.0), random.Uniform(-10.0, 10.0), random.Normal()};
    points.push_back(p);
    moved.emplace_back(std::cos(yaw) * p.x() - std::sin(yaw) * p.y(), std::sin(yaw) * p.x() + std::cos(yaw) * p.y(),
                       p.z() + plane.x() * p.x() + plane.y() * p.y() + plane.z());
  }
  RC_ASSERT(std::abs(SpreadAboutPlane(points).rms_m - SpreadAboutPlane(moved).rms_m) < 1e-6);
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
