#include "worker/rays/photo_pyramid.h"

#include <gtest/gtest.h>

#include <array>

namespace skyquilt::worker {
namespace {

std::array<double, kPyramidLevels> Drawn(const PhotoPyramid& pyramid) {
  constexpr int kDraws = 40'000;
  base::Random random(9);
  std::array<double, kPyramidLevels> shares = {};
  for (int i = 0; i < kDraws; ++i) shares[static_cast<size_t>(pyramid.Draw(random))] += 1.0 / kDraws;
  return shares;
}

TEST(PhotoPyramid, DrawsLevelsInTheirShares) {
  const auto shares = Drawn({{60, 20, 12, 8}, {}, 0.5, 0.0});
  EXPECT_NEAR(shares[0], 0.60, 0.01);
  EXPECT_NEAR(shares[1], 0.20, 0.01);
  EXPECT_NEAR(shares[2], 0.12, 0.01);
  EXPECT_NEAR(shares[3], 0.08, 0.01);
}

TEST(PhotoPyramid, ChangesItsSharesOverTheBudget) {
  const std::vector<double> last = {1.0}, first = {0.0, 0.0, 1.0};
  EXPECT_NEAR(Drawn({last, first, 0.4, 0.0})[2], 1.0, 1e-9);
  EXPECT_NEAR(Drawn({last, first, 0.4, 0.2})[2], 0.5, 0.01);
  EXPECT_NEAR(Drawn({last, first, 0.4, 0.4})[0], 1.0, 1e-9);
  EXPECT_NEAR(Drawn({last, first, 0.0, 0.0})[0], 1.0, 1e-9);
}

TEST(PhotoPyramid, NeverDrawsALevelWithoutShare) {
  const auto shares = Drawn({{0.0, 0.5, 0.0, 0.0}, {}, 0.5, 0.7});
  EXPECT_NEAR(shares[1], 1.0, 1e-9);
}

TEST(PhotoPyramid, FullSizeAloneUsesNoRandomNumber) {
  base::Random random(5), untouched(5);
  EXPECT_EQ(PhotoPyramid().Draw(random), 0);
  EXPECT_EQ(PhotoPyramid({1.0}, {}, 0.5, 0.3).Draw(random), 0);
  EXPECT_EQ(random.Uniform(), untouched.Uniform());
}

TEST(PhotoPyramid, KnowsItsFinestAndCoarsestLevel) {
  EXPECT_EQ(RangeOf({1.0}, {}).coarsest, 0);
  EXPECT_EQ(RangeOf({0.6, 0.2, 0.12, 0.08}, {}).coarsest, 3);
  EXPECT_EQ(RangeOf({0.0, 0.5}, {}).finest, 1);
  EXPECT_EQ(RangeOf({1.0}, {0.0, 0.0, 1.0}).coarsest, 2);
}

}  // namespace
}  // namespace skyquilt::worker
