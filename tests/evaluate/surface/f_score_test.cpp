#include "evaluate/surface/f_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "evaluate/surface/photo_errors.h"
#include "tests/evaluate/photos/nadir_view.h"
#include "tests/evaluate/surface/surface_sample.h"

namespace skyquilt::evaluate::surface {
namespace {

using survey::SurfaceClass;

constexpr double kGsd_m = 0.1;
constexpr Plate kGround{-10, -8, -4, 8, 0.0}, kRoad{-4, -8, 0, 8, 0.0}, kRoof{0, -8, 10, 8, 3.0};

// Ground and road in the west, a roof in the east, seen by two photos from 100 m up whose frames hold all of it.
struct Place {
  TrueSurface truth;
  std::vector<photos::TrainingView> training = {photos::NadirView(0, 0, 100), photos::NadirView(1, 0, 100)};
  std::vector<geo::BlockBox> boxes = {{{-10, -8, -5}, {10, 8, 20}, 2.0}};
  base::ThreadPool threads{2};

  Place() {
    truth.middle = {5, 5, 0};
    AddPlate(kGround, SurfaceClass::kGround, &truth);
    AddPlate(kRoad, SurfaceClass::kRoad, &truth);
    AddPlate(kRoof, SurfaceClass::kRoof, &truth);
  }
  SurfaceComparison Compare(const SurfaceMesh& mesh, base::ThreadPool* with = nullptr) {
    const photos::TrainingViews views(training);
    const SeenSurface seen(truth, training, views, boxes);
    const SurfacePair pair{mesh, truth, seen, boxes, kGsd_m};
    return CompareSurfaces(pair, SampleMesh(pair), with == nullptr ? threads : *with);
  }
};

Plate Moved(Plate plate, double up_m) {
  plate.z += up_m;
  return plate;
}

// In order: 1, 2, 5 GSD (0.1, 0.2, 0.5 m), 5, 10, 20 cm.
std::vector<double> FScores(const SurfaceAgreement& agreement) {
  std::vector<double> scores;
  for (const SurfaceFScore& score : agreement.f_scores) scores.push_back(score.f);
  return scores;
}

const SurfaceAgreement& ClassOf(const SurfaceComparison& comparison, const std::string& name) {
  const std::vector<ScoredClass> classes = ScoredClasses();
  for (size_t i = 0; i < classes.size(); ++i) {
    if (classes[i].name == name) return comparison.by_class[i];
  }
  throw std::runtime_error("no class " + name);
}

class CompareSurfacesTest : public ::testing::Test, protected Place {};

TEST_F(CompareSurfacesTest, TheTruthItselfIsPerfect) {
  const SurfaceComparison same = Compare(MeshOf({kGround, kRoad, kRoof}));
  EXPECT_EQ(FScores(same.all), std::vector<double>(6, 1.0));
  EXPECT_LT(same.all.accuracy_median_m, 1e-5);
  EXPECT_LT(same.all.completeness_median_m, 1e-5);
  // 320 square metres, 200 points on each.
  EXPECT_NEAR(static_cast<double>(same.all.mesh_samples), 64000.0, 500.0);
  EXPECT_NEAR(static_cast<double>(same.all.true_samples), 64000.0, 500.0);
}

TEST_F(CompareSurfacesTest, AShiftCountsOnlyAtLargerDistances) {
  for (const double sign : {1.0, -1.0}) {
    const double up_m = sign * 3.0 * kGsd_m;
    const SurfaceComparison moved = Compare(MeshOf({Moved(kGround, up_m), Moved(kRoad, up_m), Moved(kRoof, up_m)}));
    EXPECT_EQ(FScores(moved.all), (std::vector<double>{0.0, 0.0, 1.0, 0.0, 0.0, 0.0}));
    EXPECT_NEAR(moved.all.accuracy_median_m, 0.3, 1e-5);
    EXPECT_NEAR(moved.all.completeness_median_m, 0.3, 1e-5);
  }
}

TEST_F(CompareSurfacesTest, WhatIsMissingLowersRecallOnly) {
  const SurfaceComparison half = Compare(MeshOf({kGround, kRoad}));
  for (const SurfaceFScore& score : half.all.f_scores) {
    EXPECT_EQ(score.precision, 1.0);
    EXPECT_NEAR(score.recall, 0.5, 0.05);  // the rim of the roof is not near the ground, 3 m below
  }
  EXPECT_EQ(FScores(ClassOf(half, "ground")), std::vector<double>(6, 1.0));
  EXPECT_EQ(ClassOf(half, "roof").f_scores[1].recall, 0.0);
  EXPECT_TRUE(std::isnan(ClassOf(half, "roof").f_scores[1].precision));  // no mesh is nearest to the roof
  EXPECT_TRUE(std::isinf(ClassOf(half, "roof").completeness_median_m));
}

// It is shown, but nobody measured it: it is neither right nor wrong, and what it covers is missing.
TEST_F(CompareSurfacesTest, WhatClosesGapsIsNotScored) {
  SurfaceMesh mesh = MeshOf({kGround, kRoad, kRoof, Moved(kGround, 2.0)});
  mesh.filled.assign(mesh.triangle.size(), 0);
  const size_t per_plate = mesh.triangle.size() / 4;
  std::fill_n(mesh.filled.begin() + static_cast<std::ptrdiff_t>(3 * per_plate), per_plate, 1);
  EXPECT_EQ(FScores(Compare(mesh).all), std::vector<double>(6, 1.0));
  std::fill_n(mesh.filled.begin() + static_cast<std::ptrdiff_t>(2 * per_plate), per_plate, 1);
  const SurfaceComparison half = Compare(mesh);
  EXPECT_EQ(half.all.f_scores[0].precision, 1.0);
  EXPECT_NEAR(half.all.f_scores[0].recall, 0.5, 0.05);
  std::fill(mesh.filled.begin(), mesh.filled.end(), 1);
  EXPECT_EQ(Compare(mesh).all.mesh_samples, 0);
}

TEST_F(CompareSurfacesTest, EveryClassHasItsOwnScores) {
  const SurfaceComparison mixed = Compare(MeshOf({Moved(kGround, 0.01), Moved(kRoad, 0.15), Moved(kRoof, -0.3)}));
  EXPECT_EQ(FScores(ClassOf(mixed, "road")), (std::vector<double>{0.0, 1.0, 1.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(FScores(ClassOf(mixed, "roof")), (std::vector<double>{0.0, 0.0, 1.0, 0.0, 0.0, 0.0}));
  EXPECT_NEAR(ClassOf(mixed, "ground").f_scores[0].f, 0.6, 0.02);  // roads are ground: 6 of 10 m are near
  EXPECT_EQ(ClassOf(mixed, "tree").mesh_samples, 0);
  EXPECT_TRUE(std::isnan(ClassOf(mixed, "tree").f_scores[0].f));
  EXPECT_EQ(mixed.all.mesh_samples, ClassOf(mixed, "ground").mesh_samples + ClassOf(mixed, "roof").mesh_samples);
}

TEST_F(CompareSurfacesTest, WhatNoPhotoSeesDoesNotCount) {
  const Plate cellar{-10, -8, 0, 8, -2.0};
  AddPlate(cellar, SurfaceClass::kGround, &truth);
  // Neither its absence nor its presence.
  EXPECT_EQ(FScores(Compare(MeshOf({kGround, kRoad, kRoof})).all), std::vector<double>(6, 1.0));
  EXPECT_EQ(FScores(Compare(MeshOf({kGround, kRoad, kRoof, cellar})).all), std::vector<double>(6, 1.0));
}

TEST_F(CompareSurfacesTest, InventedSurfaceInTheAirIsWrong) {
  const Plate invented{-10, -8, 10, 8, 9.0};
  const SurfaceComparison comparison = Compare(MeshOf({kGround, kRoad, kRoof, invented}));
  EXPECT_NEAR(comparison.all.f_scores[2].precision, 0.5, 0.01);
  EXPECT_EQ(comparison.all.f_scores[2].recall, 1.0);
}

TEST_F(CompareSurfacesTest, WaterAndPlacesOutsideTheSceneDoNotCount) {
  boxes = {{{-10, -8, -5}, {5, 8, 20}, 2.0}};  // the eastern half of the roof is outside
  const Plate pond{-10, -8, -8, 8, 0.05};
  AddPlate(pond, SurfaceClass::kWater, &truth);
  const Plate half_roof{0, -8, 5, 8, 3.0}, dry{-8, -8, -4, 8, 0.0};
  const SurfaceComparison without = Compare(MeshOf({dry, kRoad, half_roof}));
  EXPECT_EQ(FScores(without.all), std::vector<double>(6, 1.0));
  const SurfaceComparison with = Compare(MeshOf({dry, kRoad, half_roof, pond, {5, -8, 10, 8, 3.25}}));
  EXPECT_EQ(FScores(with.all), std::vector<double>(6, 1.0));
}

TEST_F(CompareSurfacesTest, TwoPhotosMustSeeIt) {
  training = {photos::NadirView(0, 0, 100)};
  const SurfaceComparison one = Compare(MeshOf({kGround, kRoad, kRoof}));
  EXPECT_EQ(one.all.true_samples, 0);
  EXPECT_EQ(one.all.mesh_samples, 0);
  EXPECT_TRUE(std::isnan(one.all.f_scores[0].f));
  // A roof over the ground hides it from above.
  Place roofed;
  AddPlate({-10, -8, 0, 8, 6.0}, SurfaceClass::kRoof, &roofed.truth);
  EXPECT_LT(ClassOf(roofed.Compare(MeshOf({kRoof})), "ground").true_samples, 2500);  // of 32000: what the photos see under its edges
}

TEST_F(CompareSurfacesTest, NothingToCompareIsNotAnError) {
  const SurfaceComparison none = Compare(SurfaceMesh());
  EXPECT_EQ(none.all.mesh_samples, 0);
  EXPECT_EQ(none.all.f_scores[0].recall, 0.0);
  truth = {};
  training.clear();
  boxes.clear();
  EXPECT_EQ(Compare(MeshOf({kGround})).all.true_samples, 0);
}

TEST_F(CompareSurfacesTest, SameForAnyNumberOfThreads) {
  base::ThreadPool one(1);
  const SurfaceMesh mesh = MeshOf({Moved(kGround, 0.099), {-4, -8, 0, 8, 0.1}, {0, -8, 7, 8, 3.05}});
  const SurfaceComparison a = Compare(mesh), b = Compare(mesh, &one);
  EXPECT_EQ(FScores(a.all), FScores(b.all));
  EXPECT_EQ(a.all.accuracy_median_m, b.all.accuracy_median_m);
}

TEST(SampleSurface, PointsAreSpreadByArea) {
  const SurfaceMesh mesh = MeshOf({{0, 0, 1, 1, 0}, {5, 0, 8, 1, 0}});
  const auto all = [](uint32_t) { return true; };
  const std::vector<SurfaceSample> samples = SampleSurface(mesh.position, mesh.triangle, all, 0.001, 1'000'000);
  ASSERT_EQ(samples.size(), 4000U);
  int west = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SurfaceSample& sample : samples) {
    const Eigen::Vector3d point = mesh.middle + sample.point.cast<double>();
    mean += point / 4000.0;
    west += point.x() <= 1.0 ? 1 : 0;
    EXPECT_EQ(sample.triangle < 2, point.x() <= 1.0);
  }
  EXPECT_NEAR(west, 1000, 1);
  EXPECT_NEAR(mean.x(), (0.5 + 3 * 6.5) / 4, 0.02);
  EXPECT_NEAR(mean.y(), 0.5, 0.02);
  EXPECT_EQ(SampleSurface(mesh.position, mesh.triangle, all, 0.001, 100).size(), 100U);
  EXPECT_TRUE(SampleSurface(
                  mesh.position, mesh.triangle, [](uint32_t) { return false; }, 0.001, 100)
                  .empty());
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
