#include "prepare/control/fit/control_similarity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/base/random.h"

namespace skyquilt::test {
namespace {

using namespace prepare::control;

const geo::Similarity3d kTruth = {
    3.5, Eigen::Quaterniond(Eigen::AngleAxisd(1.2, Eigen::Vector3d(0.2, 0.5, -0.8).normalized())), {100.0, -40.0, 12.0}};

ControlPair PairAt(const Eigen::Vector3d& x_in_enu, base::Random& random, double noise_m) {
  const Eigen::Vector3d noise{random.Normal(), random.Normal(), random.Normal()};
  const Eigen::Vector3d in_model = kTruth.rotation.conjugate() * ((x_in_enu - kTruth.translation) / kTruth.scale);
  return {in_model, x_in_enu + noise_m * noise, Eigen::Vector3d(0.01, 0.01, 0.02), 0.01 / kTruth.scale};
}

std::vector<ControlPair> PairsOver(int n, uint64_t seed, double noise_m = 0.01) {
  base::Random random(seed);
  std::vector<ControlPair> pairs;
  for (int i = 0; i < n; ++i) {
    pairs.push_back(PairAt({random.Uniform(-150.0, 150.0), random.Uniform(-150.0, 150.0), random.Uniform(-5.0, 5.0)}, random, noise_m));
  }
  return pairs;
}

double WorstOf(const ControlSimilarity& fit) {
  double worst = 0.0;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, -15, 2), Eigen::Vector3d(-30, 25, -2)}) {
    worst = std::max(worst, (fit.enu_from_model * x - kTruth * x).norm());
  }
  return worst;
}

TEST(ControlSimilarity, FindsItAmongWrongPoints) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<ControlPair> pairs = PairsOver(10, seed);
    pairs[2].in_enu.x() += 5.0;
    pairs[7].in_enu.z() -= 8.0;
    pairs[9].in_enu.y() += 300000.0;
    const ControlSimilarity fit = FitControlSimilarity(pairs);
    ASSERT_EQ(fit.failure, SimilarityFailure::kNone);
    for (size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(fit.agrees[i] != 0, i != 2 && i != 7 && i != 9) << "seed " << seed << ", pair " << i;
    EXPECT_LT(WorstOf(fit), 0.05);
  }
}

TEST(ControlSimilarity, ManyPointsAreSampled) {
  std::vector<ControlPair> pairs = PairsOver(80, 3);
  for (size_t i = 0; i < 20; ++i) pairs[4 * i].in_enu += Eigen::Vector3d(10.0 + static_cast<double>(i), 5.0, -4.0);
  const ControlSimilarity fit = FitControlSimilarity(pairs);
  ASSERT_EQ(fit.failure, SimilarityFailure::kNone);
  for (size_t i = 0; i < pairs.size(); ++i) EXPECT_EQ(fit.agrees[i] != 0, i % 4 != 0);
  EXPECT_LT(WorstOf(fit), 0.03);
}

TEST(ControlSimilarity, RefusesALineAndTooFew) {
  std::vector<ControlPair> line;
  base::Random random(1);
  for (int i = 0; i < 6; ++i) line.push_back(PairAt({20.0 * i, 10.0 * i, 0.0}, random, 0.01));
  EXPECT_EQ(FitControlSimilarity(line).failure, SimilarityFailure::kOnLine);
  // Two heights do not level it.
  std::vector<ControlPair> flat = PairsOver(6, 1);
  for (size_t i = 2; i < flat.size(); ++i) flat[i].sigma_m.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(FitControlSimilarity(flat).failure, SimilarityFailure::kTooFew);
}

TEST(ControlSimilarity, PointsWithoutHeightSayNothingOfIt) {
  std::vector<ControlPair> pairs = PairsOver(8, 5);
  for (size_t i = 4; i < pairs.size(); ++i) {
    pairs[i].sigma_m.z() = std::numeric_limits<double>::infinity();
    pairs[i].in_enu.z() = 1000.0;
  }
  const ControlSimilarity fit = FitControlSimilarity(pairs);
  ASSERT_EQ(fit.failure, SimilarityFailure::kNone);
  for (const char agrees : fit.agrees) EXPECT_NE(agrees, 0);
  EXPECT_LT(WorstOf(fit), 0.1);
}

// A model that is bent by more than coordinates explain is still placed by most of its points.
TEST(ControlSimilarity, PlacesABentModel) {
  std::vector<ControlPair> pairs = PairsOver(12, 9);
  for (ControlPair& pair : pairs) pair.in_enu.z() += 8.0 * pair.in_enu.head<2>().squaredNorm() / (150.0 * 150.0);
  const ControlSimilarity fit = FitControlSimilarity(pairs);
  ASSERT_EQ(fit.failure, SimilarityFailure::kNone);
  EXPECT_LT((fit.enu_from_model * pairs[0].in_model - pairs[0].in_enu).head<2>().norm(), 2.0);
  EXPECT_GT(fit.CovarianceAt(pairs[0].in_enu).diagonal().z(), 0.05);  // and says that it is not accurate
}

}  // namespace
}  // namespace skyquilt::test
