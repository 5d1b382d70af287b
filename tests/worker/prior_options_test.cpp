#include "worker/prior_options.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"

namespace skyquilt::worker {
namespace {

TEST(PriorOptions, WeightsGrowBetweenTheTwoShares) {
  const PriorOptions options;  // 0.3, 0.6
  EXPECT_EQ(options.Strength(0.0), 0.0);
  EXPECT_EQ(options.Strength(0.29), 0.0);
  EXPECT_NEAR(options.Strength(0.45), 0.5, 1e-12);
  EXPECT_EQ(options.Strength(0.6), 1.0);
  EXPECT_EQ(options.Strength(1.0), 1.0);
}

TEST(PriorOptions, PointsFadeFromTheSecondShareToTheirEnd) {
  PriorOptions options;  // 0.3, 0.6, 0.8
  EXPECT_EQ(options.PointStrength(0.29), 0.0);
  EXPECT_NEAR(options.PointStrength(0.45), 0.5, 1e-12);
  EXPECT_NEAR(options.PointStrength(0.6), 1.0, 1e-12);
  EXPECT_NEAR(options.PointStrength(0.7), 0.5, 1e-12);
  EXPECT_EQ(options.PointStrength(0.8), 0.0);
  EXPECT_EQ(options.PointStrength(1.5), 0.0);
  options.points_end = options.until;
  EXPECT_NEAR(options.PointStrength(0.5), 2.0 / 3.0, 1e-12);
  EXPECT_EQ(options.PointStrength(0.6), 0.0);
}

TEST(PriorOptions, MayBeginAtFullSize) {
  PriorOptions options;
  options.from = options.until = 0.5;
  EXPECT_EQ(options.Strength(0.49), 0.0);
  EXPECT_EQ(options.Strength(0.5), 1.0);
}

TEST(PriorOptions, ImpossibleOnesAreRefused) {
  PriorOptions options;
  options.until = 0.1;
  EXPECT_THROW(options.Check("priors"), base::UsageError);
  options = {};
  options.points_end = 0.5;
  EXPECT_THROW(options.Check("priors"), base::UsageError);
  options = {};
  options.planar = -1.0;
  EXPECT_THROW(options.Check("priors"), base::UsageError);
  options = {};
  EXPECT_NO_THROW(options.Check("priors"));
  EXPECT_FALSE(options.Segments());
  EXPECT_TRUE(options.Planes());
}

}  // namespace
}  // namespace skyquilt::worker
