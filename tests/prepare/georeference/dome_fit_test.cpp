#include "prepare/georeference/dome_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/base/random.h"
#include "tests/support/not_finite.h"

namespace skyquilt::prepare::georeference {
namespace {

// Lines of `columns` photos, flown to and fro, 20 m apart in both directions.
std::vector<HeightDifference> Lines(int rows, int columns, const std::function<double(const Eigen::Vector2d&)>& up_m) {
  std::vector<HeightDifference> differences;
  for (int row = 0; row < rows; ++row) {
    for (int k = 0; k < columns; ++k) {
      const int column = row % 2 == 0 ? k : columns - 1 - k;
      const Eigen::Vector2d position(500.0 + 20.0 * column, -300.0 + 20.0 * row);
      differences.push_back({position, up_m(position)});
    }
  }
  return differences;
}

// Square of the distance from the mean position that 95 % of the positions do not exceed.
double EdgeSquared(const std::vector<HeightDifference>& differences) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const HeightDifference& d : differences) mean += d.position_m / static_cast<double>(differences.size());
  std::vector<double> squared;
  squared.reserve(differences.size());
  for (const HeightDifference& d : differences) squared.push_back((d.position_m - mean).squaredNorm());
  std::sort(squared.begin(), squared.end());
  return squared[static_cast<size_t>(std::lround(0.95 * static_cast<double>(squared.size() - 1)))];
}

TEST(DomeFit, FindsAKnownDomeUnderAnyPlane) {
  for (const double per_square_metre : {-3e-4, 0.0, 2e-4}) {
    const auto differences =
        Lines(11, 11, [&](const Eigen::Vector2d& p) { return 12.0 + 0.03 * p.x() - 0.05 * p.y() - per_square_metre * p.squaredNorm(); });
    const Dome dome = FitDome(differences);
    // Up is less at the edge than in the middle when per_square_metre is positive.
    EXPECT_NEAR(dome.height_m, per_square_metre * EdgeSquared(differences), 1e-6);
    EXPECT_LT(dome.sigma_m, 1e-6);
  }
}

TEST(DomeFit, AFewWrongTagsHardlyMatter) {
  base::Random random(4);
  auto differences = Lines(9, 12, [&](const Eigen::Vector2d&) { return random.Normal(); });
  const Dome without = FitDome(differences);
  for (size_t i = 40; i < differences.size(); i += 13) differences[i].up_m += 30.0;
  const Dome with = FitDome(differences);
  EXPECT_NEAR(with.height_m, without.height_m, 0.7);
  EXPECT_LT(with.sigma_m, 2.0 * without.sigma_m);
}

struct Coverage {
  double within = 0.0;  // share of domes within 1.96 sigma of the truth
  double alarms = 0.0;  // share farther away than 3 sigma
};

// Noise of standard deviation 1 m, of which each value remembers `memory` of the one before.
Coverage CoverageOf(double true_dome_m, double memory) {
  constexpr int kSeeds = 400;
  Coverage coverage;
  const double edge_squared = EdgeSquared(Lines(8, 10, [](const Eigen::Vector2d&) { return 0.0; }));
  for (int seed = 0; seed < kSeeds; ++seed) {
    base::Random random(static_cast<uint64_t>(seed) + 1);
    double noise = random.Normal();
    const Dome dome = FitDome(Lines(8, 10, [&](const Eigen::Vector2d& p) {
      noise = memory * noise + std::sqrt(1.0 - memory * memory) * random.Normal();
      return noise - true_dome_m * p.squaredNorm() / edge_squared;
    }));
    const double error = std::abs(dome.height_m - true_dome_m);
    coverage.within += error < 1.96 * dome.sigma_m ? 1.0 / kSeeds : 0.0;
    coverage.alarms += error > 3.0 * dome.sigma_m ? 1.0 / kSeeds : 0.0;
  }
  return coverage;
}

TEST(DomeFit, SigmaCoversTheErrorOfIndependentNoise) {
  for (const double dome_m : {0.0, 3.0}) {
    const Coverage coverage = CoverageOf(dome_m, 0.0);
    EXPECT_GT(coverage.within, 0.90) << dome_m;
    EXPECT_LT(coverage.within, 0.995) << dome_m;
    EXPECT_LT(coverage.alarms, 0.02) << dome_m;
  }
}

TEST(DomeFit, SigmaCoversTheErrorOfDriftingHeights) {
  const Coverage coverage = CoverageOf(0.0, 0.8);
  EXPECT_GT(coverage.within, 0.90);
  EXPECT_LT(coverage.alarms, 0.02);
}

TEST(DomeFit, SaysNothingWhenPositionsDoNotShowIt) {
  const auto flat = [](const Eigen::Vector2d& p) { return 0.01 * p.x(); };
  const auto unknown = [](const Dome& dome) { return std::isnan(dome.height_m) && std::isnan(dome.sigma_m); };
  EXPECT_TRUE(unknown(FitDome({})));
  EXPECT_TRUE(unknown(FitDome(Lines(3, 3, flat))));
  EXPECT_FALSE(unknown(FitDome(Lines(2, 5, flat))));
  EXPECT_TRUE(unknown(FitDome(Lines(1, 40, flat))));
  EXPECT_TRUE(unknown(FitDome(Lines(2, 60, flat))));
  EXPECT_TRUE(unknown(FitDome(std::vector<HeightDifference>(30, {{5.0, 6.0}, 1.0}))));
  std::vector<HeightDifference> circle;
  circle.reserve(24);
  for (int i = 0; i < 24; ++i) circle.push_back({50.0 * Eigen::Vector2d(std::cos(0.2618 * i), std::sin(0.2618 * i)), 0.1 * i});
  EXPECT_TRUE(unknown(FitDome(circle)));
}

TEST(DomeFit, LeavesOutWhatIsNotFinite) {
  const auto differences = Lines(5, 6, [](const Eigen::Vector2d& p) { return 1e-3 * p.squaredNorm(); });
  auto with_gaps = differences;
  with_gaps.insert(with_gaps.begin() + 7, {{3.0, 4.0}, kNan});
  with_gaps.push_back({{kNan, 0.0}, 1.0});
  with_gaps.push_back({{0.0, 0.0}, std::numeric_limits<double>::infinity()});
  EXPECT_EQ(FitDome(with_gaps).height_m, FitDome(differences).height_m);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
