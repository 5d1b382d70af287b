#include "prepare/georeference/horizontal_fit.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "prepare/georeference/tags/track.h"
#include "tests/prepare/georeference/lawnmower_photos.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector2d;

constexpr int kTags = 60;
const HorizontalSimilarity kTruth{.scale = 12.5, .angle = 2.3, .translation = {40.0, -70.0}};

// Levelled positions on a lawnmower, in model units.
std::vector<Vector2d> Level() {
  std::vector<Vector2d> level;
  level.reserve(kTags);
  for (int i = 0; i < kTags; ++i) level.emplace_back(test::OnLawnmower(i, kTags).head<2>() / kTruth.scale);
  return level;
}

std::vector<Vector2d> TagsOf(const std::vector<Vector2d>& level, double noise_m, uint64_t seed) {
  base::Random random(seed);
  std::vector<Vector2d> tags;
  tags.reserve(level.size());
  for (const Vector2d& x : level) tags.emplace_back(kTruth * x + noise_m * Vector2d{random.Normal(), random.Normal()});
  return tags;
}

HorizontalFit Fit(const std::vector<Vector2d>& tags, const std::vector<Vector2d>& level, const HorizontalFitOptions& options = {}) {
  return FitHorizontally(
      tags, [&](size_t k, double) { return level[k]; }, options);
}

// Largest difference over the flight, metres.
double Difference(const HorizontalSimilarity& a, const HorizontalSimilarity& b) {
  double largest = 0.0;
  for (const Vector2d& x : Level()) largest = std::max(largest, (a * x - b * x).norm());
  return largest;
}

TEST(FitHorizontally, ExactTagsGiveTheExactSimilarity) {
  const HorizontalFit fit = Fit(TagsOf(Level(), 0.0, 1), Level());
  ASSERT_TRUE(fit.ok);
  EXPECT_LT(Difference(fit.enu_from_level, kTruth), 1e-9);
  EXPECT_NEAR(fit.enu_from_level.scale, kTruth.scale, 1e-10);
  EXPECT_NEAR(fit.enu_from_level.angle, kTruth.angle, 1e-10);
  EXPECT_EQ(fit.n_inliers, kTags);
  EXPECT_LT(fit.cost, 1e-15);
}

TEST(FitHorizontally, FourTagsOfTenMayBeWrong) {
  std::vector<Vector2d> tags = TagsOf(Level(), 0.5, 2);
  base::Random random(3);
  for (size_t k = 0; k < tags.size(); ++k) {
    if (k % 5 < 2) tags[k] += 200.0 * Vector2d{random.Uniform(0.2, 1.0), random.Uniform(-1.0, 1.0)};
  }
  const HorizontalFit fit = Fit(tags, Level());
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.n_inliers, 36);
  for (size_t k = 0; k < tags.size(); ++k) EXPECT_EQ(fit.inlier[k] != 0, k % 5 >= 2) << k;
  EXPECT_LT(Difference(fit.enu_from_level, kTruth), 0.6);
}

TEST(FitHorizontally, OfTwoGroupsTheLargerWins) {
  for (const bool first_is_larger : {true, false}) {
    std::vector<Vector2d> tags = TagsOf(Level(), 0.5, 4);
    for (int k = 0; k < kTags; ++k) {
      if (first_is_larger == (k >= (first_is_larger ? 36 : 24))) tags[static_cast<size_t>(k)] += Vector2d(18.0, 0.0);
    }
    const HorizontalFit fit = Fit(tags, Level());
    ASSERT_TRUE(fit.ok);
    EXPECT_EQ(fit.n_inliers, 36);
    EXPECT_LT(Difference(fit.enu_from_level, kTruth), 1.0);
  }
}

TEST(FitHorizontally, FindsTheLagOnALawnmower) {
  base::Random random(5);
  const geo::Similarity3d model_from_enu{0.1, Eigen::Quaterniond::Identity(), Eigen::Vector3d(1.0, 2.0, 3.0)};
  const std::vector<input::PreparedPhoto> photos = test::LawnmowerPhotos(kTags, model_from_enu);
  const Track track(photos, std::vector<int>(kTags, 0));
  const auto level = [&](size_t k, double lag_s) { return Vector2d(track.Before(k, lag_s).position.head<2>()); };
  HorizontalFitOptions options;
  for (double lag_s = -1.5; lag_s <= 5.0; lag_s += 0.25) options.lags_s.push_back(lag_s);
  for (const double lag_s : {-0.75, 0.0, 1.25, 4.0}) {
    std::vector<Vector2d> tags;
    for (size_t k = 0; k < kTags; ++k) tags.emplace_back(kTruth * level(k, lag_s) + 0.5 * Vector2d{random.Normal(), random.Normal()});
    const HorizontalFit fit = FitHorizontally(tags, level, options);
    ASSERT_TRUE(fit.ok);
    EXPECT_EQ(fit.lag_s, lag_s);
  }
}

TEST(FitHorizontally, OfEqualLagsZeroWins) {
  // On a straight line at constant speed a lag is a shift along the line.
  const auto level = [](size_t k, double lag_s) { return Vector2d(static_cast<double>(k) - lag_s, 0.0); };
  std::vector<Vector2d> tags;
  for (size_t k = 0; k < 20; ++k) tags.emplace_back(kTruth * level(k, 2.0));
  const HorizontalFit fit = FitHorizontally(tags, level, {.lags_s = {3.0, 2.0, 1.0, 0.0, -1.0}});
  ASSERT_TRUE(fit.ok);
  EXPECT_EQ(fit.lag_s, 0.0);
  EXPECT_NEAR(fit.enu_from_level.scale, kTruth.scale, 1e-9);
}

TEST(FitHorizontally, TheSameSeedGivesTheSameBits) {
  std::vector<Vector2d> tags = TagsOf(Level(), 4.0, 6);
  for (size_t k = 0; k < tags.size(); k += 3) tags[k].x() += 35.0;
  const HorizontalFit a = Fit(tags, Level(), {.seed = 9}), b = Fit(tags, Level(), {.seed = 9});
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_EQ(a.enu_from_level.scale, b.enu_from_level.scale);
  EXPECT_EQ(a.enu_from_level.angle, b.enu_from_level.angle);
  EXPECT_EQ(a.enu_from_level.translation, b.enu_from_level.translation);
  EXPECT_EQ(a.inlier, b.inlier);
}

TEST(FitHorizontally, FailsWithoutTwoPlaces) {
  EXPECT_FALSE(Fit({}, {}).ok);
  EXPECT_FALSE(Fit({Vector2d::Zero()}, {Vector2d::Zero()}).ok);
  const std::vector<Vector2d> here(10, Vector2d(3.0, 4.0));
  std::vector<Vector2d> row;
  row.reserve(10);
  for (int i = 0; i < 10; ++i) row.emplace_back(i, 1.0);
  EXPECT_FALSE(Fit(here, row).ok);
  EXPECT_FALSE(Fit(row, here).ok);
  EXPECT_EQ(Fit(row, here).inlier.size(), 10U);
}

// A third of the tags is wrong by far more than the threshold.
std::vector<Vector2d> TagsWithOutliers(uint64_t seed) {
  std::vector<Vector2d> tags = TagsOf(Level(), 1.0, seed);
  base::Random random(seed, 1);
  for (size_t k = 0; k < tags.size(); k += 3) tags[k] += Vector2d{random.Uniform(60.0, 300.0), random.Uniform(60.0, 300.0)};
  return tags;
}

RC_GTEST_PROP(FitHorizontally, DoesNotDependOnTheModelsFrame, ()) {
  const auto number = [](int low, int high) { return static_cast<double>(*rc::gen::inRange(low, high)); };
  const HorizontalSimilarity frame{
      .scale = std::exp(0.1 * number(-40, 40)), .angle = 0.01 * number(0, 628), .translation = {number(-1000, 1000), 5.0}};
  const std::vector<Vector2d> tags = TagsWithOutliers(*rc::gen::inRange<uint64_t>(1, 1000));
  const std::vector<Vector2d> level = Level();
  std::vector<Vector2d> moved;
  moved.reserve(level.size());
  for (const Vector2d& x : level) moved.emplace_back(frame * x);
  const HorizontalFit here = Fit(tags, level), there = Fit(tags, moved);
  RC_ASSERT(here.ok && there.ok);
  RC_ASSERT(here.inlier == there.inlier);
  for (size_t k = 0; k < level.size(); ++k) RC_ASSERT((here.enu_from_level * level[k] - there.enu_from_level * moved[k]).norm() < 1e-6);
}

RC_GTEST_PROP(FitHorizontally, DoesNotDependOnTheOrderOfTags, ()) {
  const std::vector<Vector2d> tags = TagsWithOutliers(*rc::gen::inRange<uint64_t>(1, 1000));
  const std::vector<Vector2d> level = Level();
  std::vector<size_t> order(tags.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  base::Random random(*rc::gen::inRange<uint64_t>(1, 1000));
  for (size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random.Below(static_cast<uint32_t>(k))]);
  std::vector<Vector2d> other_tags, other_level;
  for (const size_t k : order) {
    other_tags.push_back(tags[k]);
    other_level.push_back(level[k]);
  }
  const HorizontalFit fit = Fit(tags, level), other = Fit(other_tags, other_level);
  RC_ASSERT(fit.ok && other.ok);
  RC_ASSERT(fit.n_inliers == 40 && other.n_inliers == 40);
  RC_ASSERT(Difference(fit.enu_from_level, other.enu_from_level) < 1e-6);
}

}  // namespace
}  // namespace skyquilt::prepare::georeference
