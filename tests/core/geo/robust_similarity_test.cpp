#include "core/geo/robust_similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "core/base/random.h"

namespace skyquilt::geo {
namespace {

using Vectors = std::vector<Eigen::Vector3d>;

struct Problem {
  Similarity3d b_from_a;
  Vectors a;
  Vectors b;
  std::vector<char> is_outlier;
};

Similarity3d RandomSimilarity(base::Random& random) {
  Similarity3d transform;
  transform.scale = std::exp(random.Uniform(-2.0, 4.0));
  transform.rotation = Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}.normalized();
  transform.translation = {random.Uniform(-500.0, 500.0), random.Uniform(-500.0, 500.0), random.Uniform(-50.0, 50.0)};
  return transform;
}

// Camera positions of a survey in metres: 8 lines of 10 photos at almost one height.
Vectors GridPositions(base::Random& random, double height_noise_m) {
  Vectors positions;
  for (int line = 0; line < 8; ++line) {
    for (int photo = 0; photo < 10; ++photo) positions.emplace_back(30.0 * photo, 40.0 * line, 100.0 + height_noise_m * random.Normal());
  }
  return positions;
}

Problem MakeProblem(base::Random& random, const Vectors& b, double noise_m, double outlier_share) {
  Problem problem;
  problem.b_from_a = RandomSimilarity(random);
  for (const Eigen::Vector3d& x_in_b : b) {
    problem.a.push_back(problem.b_from_a.rotation.conjugate() * (x_in_b - problem.b_from_a.translation) / problem.b_from_a.scale);
    const bool is_outlier = random.UniformDouble() < outlier_share;
    problem.is_outlier.push_back(is_outlier ? 1 : 0);
    Eigen::Vector3d error{noise_m * random.Normal(), noise_m * random.Normal(), noise_m * random.Normal()};
    if (is_outlier) error = Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized() * random.Uniform(40.0, 4000.0);
    problem.b.push_back(x_in_b + error);
  }
  return problem;
}

TEST(RobustSimilarity, RecoversTheTransformAmongOutliers) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    base::Random random(seed);
    const Problem problem = MakeProblem(random, GridPositions(random, 2.0), 0.0, 0.3);
    const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
    ASSERT_TRUE(fit.ok) << fit.reason << ", seed " << seed;
    EXPECT_NEAR(fit.b_from_a.scale / problem.b_from_a.scale, 1.0, 1e-9);
    EXPECT_LT(fit.b_from_a.rotation.angularDistance(problem.b_from_a.rotation), 1e-7);
    for (size_t i = 0; i < problem.a.size(); ++i) {
      ASSERT_EQ(fit.inlier[i] != 0, problem.is_outlier[i] == 0) << "match " << i << ", seed " << seed;
      if (!problem.is_outlier[i]) {
        EXPECT_LT((fit.b_from_a * problem.a[i] - problem.b[i]).norm(), 1e-6);
      }
    }
    EXPECT_LT(fit.rmse_m, 1e-6);
  }
}

TEST(RobustSimilarity, NoiseAveragesOut) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    base::Random random(seed, 1);
    const Problem problem = MakeProblem(random, GridPositions(random, 2.0), 1.5, 0.3);
    const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
    ASSERT_TRUE(fit.ok) << fit.reason;
    // Noise of 1.5 m per axis is 2.6 m in space; about 56 inliers leave 0.2 m per axis in the centre and less than 1 m at the corners.
    EXPECT_NEAR(fit.rmse_m, 2.6, 0.6);
    for (size_t i = 0; i < problem.a.size(); ++i) {
      EXPECT_LT((fit.b_from_a * problem.a[i] - problem.b_from_a * problem.a[i]).norm(), 1.5) << "match " << i << ", seed " << seed;
    }
  }
}

TEST(RobustSimilarity, FlatGridIsEnough) {
  base::Random random(3);
  const Problem problem = MakeProblem(random, GridPositions(random, 0.0), 0.0, 0.0);
  const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
  ASSERT_TRUE(fit.ok) << fit.reason;
  EXPECT_LT(fit.b_from_a.rotation.angularDistance(problem.b_from_a.rotation), 1e-7);
}

TEST(RobustSimilarity, NarrowCorridorIsEnough) {
  base::Random random(4);
  Vectors positions;
  for (int photo = 0; photo < 100; ++photo) positions.emplace_back(30.0 * photo, photo % 2 == 0 ? 0.0 : 30.0, 100.0);
  const Problem problem = MakeProblem(random, positions, 1.0, 0.0);
  const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
  ASSERT_TRUE(fit.ok) << fit.reason;
  EXPECT_LT(fit.b_from_a.rotation.angularDistance(problem.b_from_a.rotation), 0.05);
}

TEST(RobustSimilarity, StraightLineIsDegenerateWithAndWithoutNoise) {
  for (const double noise_m : {0.0, 0.01, 1.0, 3.0}) {
    for (uint64_t seed = 1; seed <= 10; ++seed) {
      base::Random random(seed, 2);
      Vectors positions;
      for (int photo = 0; photo < 40; ++photo) positions.emplace_back(20.0 * photo, 5.0 * photo, 100.0);
      const Problem problem = MakeProblem(random, positions, noise_m, 0.0);
      const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
      EXPECT_FALSE(fit.ok) << "noise " << noise_m << ", seed " << seed;
      EXPECT_NE(std::string(fit.reason).find("line"), std::string::npos) << fit.reason;
    }
  }
}

TEST(RobustSimilarity, LineWithOutliersIsStillALine) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    base::Random random(seed, 3);
    Vectors positions;
    for (int photo = 0; photo < 40; ++photo) positions.emplace_back(20.0 * photo, 0.0, 100.0);
    const Problem problem = MakeProblem(random, positions, 0.5, 0.2);
    EXPECT_FALSE(FitSimilarityRobustly(problem.a, problem.b, {}).ok) << "seed " << seed;
  }
}

TEST(RobustSimilarity, OnePlaceIsDegenerate) {
  const Vectors same(20, Eigen::Vector3d(5.0, 6.0, 7.0));
  base::Random random(5);
  const Vectors spread = GridPositions(random, 1.0);
  const Vectors some(spread.begin(), spread.begin() + 20);
  for (const auto& [a, b] : {std::pair(same, some), std::pair(some, same), std::pair(same, same)}) {
    const RobustSimilarityFit fit = FitSimilarityRobustly(a, b, {});
    EXPECT_FALSE(fit.ok);
    EXPECT_NE(std::string(fit.reason).find("one place"), std::string::npos) << fit.reason;
  }
}

TEST(RobustSimilarity, TooFewMatches) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FitSimilarityRobustly({}, {}, {}).ok);
  const Vectors two = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(FitSimilarityRobustly(two, two, {}).ok);
  const Vectors a = {{0, 0, 0}, {1, 0, 0}, {nan, 1, 0}};
  const Vectors b = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const RobustSimilarityFit fit = FitSimilarityRobustly(a, b, {});
  EXPECT_FALSE(fit.ok);
  EXPECT_NE(std::string(fit.reason).find("fewer than 3"), std::string::npos);
  EXPECT_EQ(fit.inlier.size(), 3U);
}

TEST(RobustSimilarity, ThreeMatchesAreEnough) {
  base::Random random(6);
  const Problem problem = MakeProblem(random, {{0, 0, 100}, {50, 0, 100}, {0, 70, 90}}, 0.0, 0.0);
  const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
  ASSERT_TRUE(fit.ok) << fit.reason;
  EXPECT_LT(fit.b_from_a.rotation.angularDistance(problem.b_from_a.rotation), 1e-6);
}

TEST(RobustSimilarity, NonFiniteMatchesAreNeverInliers) {
  base::Random random(7);
  Problem problem = MakeProblem(random, GridPositions(random, 2.0), 0.5, 0.0);
  problem.a[3].x() = std::numeric_limits<double>::quiet_NaN();
  problem.b[9].z() = std::numeric_limits<double>::infinity();
  const RobustSimilarityFit fit = FitSimilarityRobustly(problem.a, problem.b, {});
  ASSERT_TRUE(fit.ok) << fit.reason;
  EXPECT_EQ(fit.n_inliers, static_cast<int>(problem.a.size()) - 2);
  EXPECT_FALSE(fit.inlier[3]);
  EXPECT_FALSE(fit.inlier[9]);
  EXPECT_TRUE(std::isfinite(fit.rmse_m));
}

TEST(RobustSimilarity, MirrorImageIsNotAFit) {
  base::Random random(8);
  Vectors a;
  for (int i = 0; i < 50; ++i) a.push_back({random.Uniform(-200.0, 200.0), random.Uniform(-200.0, 200.0), random.Uniform(-200.0, 200.0)});
  Vectors b = a;
  for (Eigen::Vector3d& x : b) x.z() = -x.z();
  const RobustSimilarityFit fit = FitSimilarityRobustly(a, b, {});
  EXPECT_LT(fit.n_inliers, 25);
  EXPECT_NEAR(fit.b_from_a.rotation.toRotationMatrix().determinant(), 1.0, 1e-9);
}

TEST(RobustSimilarity, SameSeedSameBits) {
  base::Random random(9);
  const Problem problem = MakeProblem(random, GridPositions(random, 2.0), 1.0, 0.3);
  const RobustSimilarityFit one = FitSimilarityRobustly(problem.a, problem.b, {});
  const RobustSimilarityFit two = FitSimilarityRobustly(problem.a, problem.b, {});
  EXPECT_EQ(one.b_from_a.scale, two.b_from_a.scale);
  EXPECT_EQ(one.b_from_a.translation, two.b_from_a.translation);
  EXPECT_EQ(one.residual_m, two.residual_m);
}

TEST(RobustSimilarity, UnequalLengthsAreABug) {
  EXPECT_THROW(FitSimilarityRobustly(Vectors(3), Vectors(4), {}), std::logic_error);
}

}  // namespace
}  // namespace skyquilt::geo
