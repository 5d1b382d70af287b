#include "evaluate/surface/decks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/evaluate/surface/surface_sample.h"

namespace skyquilt::evaluate::surface {
namespace {

using survey::SurfaceClass;

// 18 m x 10 m without the machine and a metre around it: 4 + 4 * 2 square metres and four corners of about 0.4.
constexpr double kOpenDeck_m2 = 180.0 - 13.6;

// A flat roof of 20 m x 12 m at height 10 with a machine of 2 m x 2 m on it, ground around.
struct FlatRoof {
  TrueSurface truth;
  photos::RoofArea area{{0, 0}, {1, 0}, {9.0, 5.0}};
  base::ThreadPool threads{2};

  FlatRoof() {
    AddPlate({-30, -30, 30, 30, 0.0}, SurfaceClass::kGround, &truth);
    AddPlate({-10, -6, 10, 6, 10.0}, SurfaceClass::kRoof, &truth);
    AddPlate({3, -1, 5, 1, 12.0}, SurfaceClass::kRoof, &truth);
  }
  DeckScore Score(const SurfaceMesh& mesh) {
    const raytrace::TracedScene traced_mesh(mesh.position, mesh.triangle), traced_truth(truth.position, truth.triangle);
    const auto samples = SampleSurface(
        mesh.position, mesh.triangle, [](uint32_t) { return true; }, 0.01, 100000);
    return ScoreDecks(mesh, samples, truth, traced_mesh, traced_truth, std::vector<photos::RoofArea>{area}, 0.1, threads);
  }
};

class ScoreDecksTest : public ::testing::Test, protected FlatRoof {};

TEST_F(ScoreDecksTest, AMeshAtTheHeightOfTheDeckIsRight) {
  const DeckScore score = Score(MeshOf({{-10, -6, 10, 6, 10.05}, {3, -1, 5, 1, 12.0}}));
  EXPECT_EQ(score.share_within, 1.0);
  EXPECT_NEAR(static_cast<double>(score.samples), 100.0 * kOpenDeck_m2, 60.0);
}

TEST_F(ScoreDecksTest, ATiltedMeshIsRightInTheMiddleOnly) {
  skyquilt::surface::TexturedTile tile = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : tile.position) p.z() += 0.04 * p.x();
  std::vector<skyquilt::surface::TexturedTile> tiles = {tile};
  // Within 0.1 m where |x| < 2.5 m.
  EXPECT_NEAR(Score(SurfaceMesh(tiles)).share_within, 5.0 * 10.0 / kOpenDeck_m2, 0.03);
}

TEST_F(ScoreDecksTest, OnlyWhatFacesUpCounts) {
  skyquilt::surface::TexturedTile floating = PlateTile({-10, -6, 10, 6, 11.0}), wall = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : wall.position) p = {p.x(), -3.0, 10.0 + p.y()};
  EXPECT_EQ(Score(SurfaceMesh({PlateTile({-10, -6, 10, 6, 10.0}), wall})).share_within, 1.0);
  EXPECT_NEAR(Score(SurfaceMesh({PlateTile({-10, -6, 10, 6, 10.0}), floating})).share_within, 0.5, 0.01);
}

TEST_F(ScoreDecksTest, OtherStoreysAreNoDeckButDoubleLayersAndHolesAre) {
  const Plate deck{-10, -6, 10, 6, 10.0}, west{-10, -6, 0, 6, 10.0};
  EXPECT_EQ(Score(MeshOf({deck, {-10, -6, 10, 6, 3.0}})).share_within, 1.0);
  EXPECT_NEAR(Score(MeshOf({deck, {-10, -6, 10, 6, 9.5}})).share_within, 0.5, 0.01);
  EXPECT_NEAR(Score(MeshOf({west, {0, -6, 10, 6, 3.0}})).share_within, 0.54, 0.02);
}

TEST_F(ScoreDecksTest, RoofsThatAreMovedWithTheSurveyAreFound) {
  truth.survey_from_truth = {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())), {100, 50, -3}};
  for (Eigen::Vector3f& p : truth.position) p = (truth.survey_from_truth.rotation * p.cast<double>()).cast<float>();
  truth.middle = truth.survey_from_truth.translation;
  skyquilt::surface::TexturedTile tile = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : tile.position) p = truth.survey_from_truth * p;
  const DeckScore score = Score(SurfaceMesh({tile}));
  EXPECT_EQ(score.share_within, 1.0);
  EXPECT_NEAR(static_cast<double>(score.samples), 100.0 * kOpenDeck_m2, 60.0);
}

TEST_F(ScoreDecksTest, WithoutDecksOrMeshNothingIsMeasured) {
  EXPECT_TRUE(std::isnan(Score(SurfaceMesh()).share_within));
  area.centre = {25, 25};  // ground
  EXPECT_EQ(Score(MeshOf({{-30, -30, 30, 30, 0.0}})).samples, 0);
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
