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

TEST(ScoreDecks, AMeshAtTheHeightOfTheDeckIsRight) {
  FlatRoof roof;
  const DeckScore score = roof.Score(MeshOf({{-10, -6, 10, 6, 10.05}, {3, -1, 5, 1, 12.0}}));
  EXPECT_EQ(score.share_within, 1.0);
  EXPECT_NEAR(static_cast<double>(score.samples), 100.0 * kOpenDeck_m2, 60.0);
}

TEST(ScoreDecks, ATiltedMeshIsRightInTheMiddleOnly) {
  FlatRoof roof;
  skyquilt::surface::TexturedTile tile = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : tile.position) p.z() += 0.04 * p.x();
  std::vector<skyquilt::surface::TexturedTile> tiles = {tile};
  // Within 0.1 m where |x| < 2.5 m.
  EXPECT_NEAR(roof.Score(SurfaceMesh(tiles)).share_within, 5.0 * 10.0 / kOpenDeck_m2, 0.03);
}

TEST(ScoreDecks, OnlyWhatFacesUpCounts) {
  FlatRoof roof;
  skyquilt::surface::TexturedTile floating = PlateTile({-10, -6, 10, 6, 11.0}), wall = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : wall.position) p = {p.x(), -3.0, 10.0 + p.y()};
  EXPECT_EQ(roof.Score(SurfaceMesh({PlateTile({-10, -6, 10, 6, 10.0}), wall})).share_within, 1.0);
  EXPECT_NEAR(roof.Score(SurfaceMesh({PlateTile({-10, -6, 10, 6, 10.0}), floating})).share_within, 0.5, 0.01);
}

TEST(ScoreDecks, OtherStoreysAreNoDeckButDoubleLayersAndHolesAre) {
  FlatRoof roof;
  const Plate deck{-10, -6, 10, 6, 10.0}, west{-10, -6, 0, 6, 10.0};
  EXPECT_EQ(roof.Score(MeshOf({deck, {-10, -6, 10, 6, 3.0}})).share_within, 1.0);
  EXPECT_NEAR(roof.Score(MeshOf({deck, {-10, -6, 10, 6, 9.5}})).share_within, 0.5, 0.01);
  EXPECT_NEAR(roof.Score(MeshOf({west, {0, -6, 10, 6, 3.0}})).share_within, 0.54, 0.02);
}

TEST(ScoreDecks, RoofsThatAreMovedWithTheSurveyAreFound) {
  FlatRoof roof;
  roof.truth.survey_from_truth = {Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ())), {100, 50, -3}};
  for (Eigen::Vector3f& p : roof.truth.position) p = (roof.truth.survey_from_truth.rotation * p.cast<double>()).cast<float>();
  roof.truth.middle = roof.truth.survey_from_truth.translation;
  skyquilt::surface::TexturedTile tile = PlateTile({-10, -6, 10, 6, 10.0});
  for (Eigen::Vector3d& p : tile.position) p = roof.truth.survey_from_truth * p;
  const DeckScore score = roof.Score(SurfaceMesh({tile}));
  EXPECT_EQ(score.share_within, 1.0);
  EXPECT_NEAR(static_cast<double>(score.samples), 100.0 * kOpenDeck_m2, 60.0);
}

TEST(ScoreDecks, WithoutDecksOrMeshNothingIsMeasured) {
  FlatRoof roof;
  EXPECT_TRUE(std::isnan(roof.Score(SurfaceMesh()).share_within));
  roof.area.centre = {25, 25};  // ground
  EXPECT_EQ(roof.Score(MeshOf({{-30, -30, 30, 30, 0.0}})).samples, 0);
}

}  // namespace
}  // namespace skyquilt::evaluate::surface
