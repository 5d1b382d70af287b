#include "prepare/georeference/height_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/order_statistics.h"
#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Index;

constexpr int kHeightTags = 100;
constexpr double kNoise_m = 2.0;
constexpr double kTiltSigma_deg = 0.1;
constexpr double kRadians = std::numbers::pi / 180.0;

// Tagged heights along a lawnmower.
struct Case {
  std::vector<int> flight;
  std::vector<double> phase;
  HeightObservations heights;

  HeightBias Bias() const { return {flight, phase, 0}; }
  // Errors of the heights by a solution.
  Eigen::VectorXd BiasOf(const BiasChoice& choice) const {
    const HeightBias bias = Bias();
    return bias.basis() * choice.solution.tail(bias.size());
  }
};

// One flight with normal noise, 3 m above the reconstruction. Relative accuracies are those of usual tags, not the noise.
Case MakeCase(int n, uint64_t seed) {
  base::Random random(seed);
  Case made;
  made.heights = {.height_m = Eigen::VectorXd(n),
                  .sigma = Eigen::VectorXd::Constant(n, 4.5),
                  .tilt = Eigen::MatrixX2d(n, 2),
                  .tilt_information = Eigen::Matrix2d::Identity() / std::pow(kTiltSigma_deg * kRadians, 2)};
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d x = test::OnLawnmower(i, n);
    made.flight.push_back(0);
    made.phase.push_back(n > 1 ? static_cast<double>(i) / (n - 1) - 0.5 : 0.0);
    made.heights.tilt.row(i) << x.y(), -x.x();
    made.heights.height_m[i] = 3.0 + kNoise_m * random.Normal();
  }
  return made;
}

double TiltDeg(const BiasChoice& choice) {
  return choice.solution.segment(1, 2).norm() / kRadians;
}

double MedianError(const Case& made, const BiasChoice& choice, const std::vector<double>& truth) {
  const Eigen::VectorXd bias = made.BiasOf(choice);
  std::vector<double> errors;
  for (Index k = 0; k < bias.size(); ++k) errors.push_back(std::abs(bias[k] + choice.solution[0] - truth[static_cast<size_t>(k)]));
  return base::Median(errors);
}

TEST(ChooseBias, GoodHeightsKeepTheBaseHypothesis) {
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const Case made = MakeCase(kHeightTags, seed);
    const BiasChoice choice = ChooseBias(made.heights, made.Bias());
    EXPECT_EQ(choice.sigmas.drift_m, choice.sigmas.offset_m) << seed;
    EXPECT_EQ(choice.sigmas.wander_m, 0.0) << seed;
    EXPECT_GT(choice.sigmas.drift_m, 0.6 * kNoise_m);
    EXPECT_LT(choice.sigmas.drift_m, 1.6 * kNoise_m);
    EXPECT_NEAR(choice.solution[0], 3.0, 1.0);
    EXPECT_LT(TiltDeg(choice), 0.3);
  }
}

TEST(ChooseBias, ADriftIsFoundAndDoesNotTilt) {
  for (const double drift_m : {100.0, -100.0, 15.0}) {
    Case made = MakeCase(kHeightTags, 21);
    for (int i = 0; i < kHeightTags; ++i) made.heights.height_m[i] += drift_m * made.phase[static_cast<size_t>(i)];
    const BiasChoice choice = ChooseBias(made.heights, made.Bias());
    const Eigen::VectorXd bias = made.BiasOf(choice);
    // The drift's own accuracy, and the tilt that it can be mistaken for: the lines advance by 135 m.
    const double sigma_m = std::hypot(kNoise_m * std::sqrt(12.0 / kHeightTags), 135.0 * kTiltSigma_deg * kRadians);
    EXPECT_NEAR(bias[kHeightTags - 1] - bias[0], drift_m, 3.0 * sigma_m);
    EXPECT_NEAR(choice.solution[0], 3.0, 1.0);
    EXPECT_LT(TiltDeg(choice), 0.2);
    EXPECT_GT(choice.sigmas.drift_m, 3.0 * choice.sigmas.offset_m);
  }
}

TEST(ChooseBias, AJumpIsFollowed) {
  Case made = MakeCase(kHeightTags, 22);
  std::vector<double> truth(kHeightTags, 3.0);
  for (int i = 60; i < kHeightTags; ++i) {
    made.heights.height_m[i] += 30.0;
    truth[static_cast<size_t>(i)] += 30.0;
  }
  const BiasChoice choice = ChooseBias(made.heights, made.Bias());
  EXPECT_GT(choice.sigmas.wander_m, 0.0);
  EXPECT_LT(MedianError(made, choice, truth), kNoise_m);
  EXPECT_LT(TiltDeg(choice), 0.2);
}

TEST(ChooseBias, FlightsGetTheirOffsets) {
  Case made = MakeCase(kHeightTags, 23);
  std::vector<double> truth(kHeightTags, 3.0);
  for (int i = 0; i < kHeightTags; ++i) {
    const auto k = static_cast<size_t>(i);
    made.flight[k] = i < 60 ? 0 : 1;
    made.phase[k] = i < 60 ? i / 59.0 - 0.5 : (i - 60) / 39.0 - 0.5;
    if (i >= 60) truth[k] -= 25.0;
    if (i >= 60) made.heights.height_m[i] -= 25.0;
  }
  const BiasChoice choice = ChooseBias(made.heights, made.Bias());
  const Eigen::VectorXd bias = made.BiasOf(choice);
  EXPECT_NEAR(bias.head(60).mean(), 0.0, 1e-9);  // of the reference flight
  EXPECT_NEAR(bias.tail(40).mean(), -25.0, 1.5);
  EXPECT_NEAR(choice.solution[0], 3.0, 1.0);
  EXPECT_GT(choice.sigmas.offset_m, choice.sigmas.drift_m);
  EXPECT_LT(MedianError(made, choice, truth), 1.0);
}

TEST(ChooseBias, OutliersDoNotPull) {
  for (const double drift_m : {0.0, 60.0}) {
    Case made = MakeCase(kHeightTags, 24);
    base::Random random(25);
    std::vector<double> truth;
    for (int i = 0; i < kHeightTags; ++i) {
      truth.push_back(3.0 + drift_m * made.phase[static_cast<size_t>(i)]);
      made.heights.height_m[i] += truth.back() - 3.0;
      if (random.Uniform() < 0.15F) made.heights.height_m[i] += random.Uniform(30.0, 80.0);
    }
    const BiasChoice choice = ChooseBias(made.heights, made.Bias());
    EXPECT_LT(MedianError(made, choice, truth), 1.0) << drift_m;
    EXPECT_LT(TiltDeg(choice), 0.2) << drift_m;
    EXPECT_EQ(choice.sigmas.wander_m, 0.0) << drift_m;
  }
}

TEST(ChooseBias, WithoutHeightsEverythingIsZero) {
  Case made = MakeCase(kHeightTags, 26);
  made.heights.sigma.setConstant(std::numeric_limits<double>::infinity());
  made.heights.height_m.setZero();
  const BiasChoice choice = ChooseBias(made.heights, made.Bias());
  EXPECT_EQ(choice.solution.size(), 3 + made.Bias().size());
  EXPECT_TRUE((choice.solution.array() == 0.0).all());
  EXPECT_EQ(choice.sigmas.drift_m, 0.0);
  EXPECT_TRUE((made.Bias().Sigmas(choice.sigmas).array() > 0.0).all());
}

TEST(ChooseBias, FewTagsGiveFiniteNumbers) {
  for (const int n : {1, 2, 3, 4, 6, 9}) {
    const Case made = MakeCase(n, 27);
    const BiasChoice choice = ChooseBias(made.heights, made.Bias());
    EXPECT_TRUE(choice.solution.allFinite()) << n;
    EXPECT_NEAR(choice.solution[0], 3.0, 3.0 * kNoise_m) << n;
    EXPECT_TRUE(std::isfinite(choice.sigmas.drift_m));
  }
  const Case made = MakeCase(5, 28);
  EXPECT_EQ(ChooseBias(made.heights, {}).solution.size(), 3);
}

TEST(ChooseBias, EqualHeightsAreNotTakenForExact) {
  Case made = MakeCase(kHeightTags, 29);
  made.heights.height_m.setConstant(7.0);
  const BiasChoice choice = ChooseBias(made.heights, made.Bias());
  EXPECT_TRUE(choice.solution.allFinite());
  EXPECT_NEAR(choice.solution[0], 7.0, 1e-6);
  EXPECT_GE(choice.sigmas.drift_m, 0.02);
}

TEST(HeightBias, ColumnsOfAFlightStayInItAndOnlyOffsetsHaveAMean) {
  const std::vector<int> flight = {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 2, 2, 2, 2};
  const std::vector<double> phase = {-0.5, -0.375, -0.25, -0.125, 0.0, 0.125, 0.25, 0.375, 0.5, -0.5, 0.5, -0.5, -0.2, 0.1, 0.5};
  const HeightBias bias(flight, phase, 2);
  // Flight 0: offset, drift and one step; 1: offset alone; 2, the reference: drift alone.
  ASSERT_EQ(bias.size(), 5);
  ASSERT_EQ(bias.basis().rows(), 15);
  const Index first[] = {0, 0, 0, 9, 11}, count[] = {9, 9, 9, 2, 4};
  for (Index j = 0; j < 5; ++j) {
    const Eigen::VectorXd column = bias.basis().col(j);
    EXPECT_NEAR(column.norm(), column.segment(first[j], count[j]).norm(), 1e-15);
    EXPECT_NEAR(column.sum(), j == 0 || j == 3 ? static_cast<double>(count[j]) : 0.0, 1e-12);
  }
  EXPECT_NEAR(bias.basis()(8, 1) - bias.basis()(0, 1), 1.0, 1e-15);
  EXPECT_EQ(bias.Sigmas({.offset_m = 7.0, .drift_m = 5.0, .wander_m = 3.0}), (Eigen::VectorXd(5) << 7.0, 5.0, 3.0, 7.0, 5.0).finished());
  EXPECT_TRUE((bias.Sigmas({}).array() > 0.0).all());
  EXPECT_EQ(HeightBias({}, {}, 0).size(), 0);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
