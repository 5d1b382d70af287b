#include "buildings/candidates/candidate_checks.h"

#include <gtest/gtest.h>

#include "tests/buildings/candidates/made_scene.h"

namespace skyquilt::buildings {
namespace {

// A box of 10 x 8 m and 6 m of height around the origin.
MadeScene BoxScene() {
  MadeScene scene;
  scene.AddBox(MadeScene::At(0.0, 0.0, 10.0, 8.0), 6.0);
  return scene;
}

struct OneBox {
  PointCloud cloud = BoxScene().Cloud();
  GroundGrid ground = BoxScene().Ground();
  std::vector<Candidate> candidates;

  OneBox() {
    base::ThreadPool threads(1);
    candidates = FindCandidates(cloud, ground, {}, MadeScene::kGsd_m, threads);
  }
  MatchedPoints Count(const std::vector<Eigen::Vector3d>& points, int n_threads = 2) const {
    base::ThreadPool threads(n_threads);
    return CountMatched(candidates, points, cloud, ground, threads).front();
  }
};

TEST(MatchedPoints, CountByHeightInsideTheOutline) {
  const OneBox box;
  ASSERT_EQ(box.candidates.size(), 1U);
  const double g = MadeScene::kGround;
  const MatchedPoints counts = box.Count({{0, 0, g},
                                          {1, 1, g + 2.9},
                                          {2, 0, g + 3.1},
                                          {3, 0, g + 9.0},  // inside
                                          {4.8, 0, g},
                                          {0, 3.8, g},  // below its eaves
                                          {8, 0, g},
                                          {0, -9, g + 6.0}});  // outside
  EXPECT_EQ(counts.low, 2);
  EXPECT_EQ(counts.high, 2);
  EXPECT_EQ(box.Count({}).low, 0);
}

TEST(MatchedPoints, DenyWhenSeveralAgree) {
  EXPECT_FALSE((MatchedPoints{.low = 0, .high = 0}).DenyRoof());
  EXPECT_FALSE((MatchedPoints{.low = 2, .high = 0}).DenyRoof());
  EXPECT_TRUE((MatchedPoints{.low = 3, .high = 0}).DenyRoof());
  EXPECT_FALSE((MatchedPoints{.low = 10, .high = 3}).DenyRoof());
  EXPECT_TRUE((MatchedPoints{.low = 12, .high = 3}).DenyRoof());
}

}  // namespace
}  // namespace skyquilt::buildings
