#include "bench/study/growth_bench.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::bench {
namespace {

RC_GTEST_PROP(FitGrowthProperty, FindsThePowerOfAPowerLaw, ()) {
  const double exponent = 0.1 * *rc::gen::inRange(-5, 25), factor = 0.01 * *rc::gen::inRange(1, 1000);
  std::vector<std::pair<double, double>> points;
  for (const double photos : {2000.0, 500.0, 5000.0, 1000.0}) points.emplace_back(photos, factor * std::pow(photos, exponent));
  const GrowthLaw law = FitGrowth(points);
  RC_ASSERT(std::abs(law.exponent - exponent) < 1e-9);
  RC_ASSERT(std::abs(law.At(20'000.0) / (factor * std::pow(20'000.0, exponent)) - 1.0) < 1e-6);
}

TEST(FitGrowth, FixedCostsOfSmallSurveysDoNotHideIt) {
  // Linear beyond 10 s that every survey takes.
  std::vector<std::pair<double, double>> points;
  for (const double photos : {10.0, 20.0, 4000.0, 8000.0}) points.emplace_back(photos, 10.0 + photos);
  EXPECT_NEAR(FitGrowth(points).exponent, 1.0, 0.01);
}

TEST(FitGrowth, NeedsTwoNumbersOfPhotos) {
  EXPECT_NE(ErrorOf<base::UsageError>([] { FitGrowth({{500.0, 1.0}, {500.0, 2.0}}); }).find("--photos"), std::string::npos);
}

GrowthResult Sample(double power) {
  GrowthResult result;
  result.memory_bytes = 4e9;
  for (const int photos : {500, 1000, 2000, 5000}) {
    GrowthRow row{.photos = photos, .blocks = photos / 50, .area_m2 = 100.0 * photos, .points = 300 * photos, .stages = {}};
    const double n = photos / 500.0;
    row.stages.push_back({"prepare", 2.0 * std::pow(n, power), 1e8 * n});
    row.stages.push_back({kBudgetedStage, 60.0 * std::pow(n, 2.0), 2e8 * n});
    result.rows.push_back(row);
  }
  return result;
}

TEST(GrowthPage, SaysWhetherTimeAndMemoryGrowAsTheyMay) {
  const BenchPage page = GrowthPage(Sample(1.0), "skyquilt bench scale");
  ASSERT_EQ(page.verdicts.size(), 2U);
  EXPECT_TRUE(page.verdicts[0].starts_with("Met")) << page.verdicts[0];
  EXPECT_TRUE(page.verdicts[1].starts_with("Met")) << page.verdicts[1];
  const std::string missed = GrowthPage(Sample(1.5), "").verdicts[0];
  EXPECT_TRUE(missed.starts_with("Missed")) << missed;
  EXPECT_NE(missed.find("prepare (1.50)"), std::string::npos) << missed;
  EXPECT_EQ(missed.find(kBudgetedStage), std::string::npos) << "its time is given";
  GrowthResult much = Sample(1.0);
  much.memory_bytes = 1e9;
  EXPECT_TRUE(GrowthPage(much, "").verdicts[1].starts_with("Missed"));
}

TEST(GrowthRow, IsReadBackWithItsIdentityAlone) {
  const GrowthRow row = Sample(1.0).rows[2];
  const std::string text = GrowthRowJson(row, "abc");
  GrowthRow read;
  ASSERT_TRUE(ParseGrowthRow(text, "abc", &read));
  EXPECT_EQ(GrowthRowJson(read, "abc"), text);
  EXPECT_EQ(read.Find("prepare")->seconds, row.Find("prepare")->seconds);
  EXPECT_EQ(read.Find("nothing"), nullptr);
  EXPECT_DOUBLE_EQ(read.PeakBytes(), 8e8);
  EXPECT_FALSE(ParseGrowthRow(text, "other", &read));
  EXPECT_FALSE(ParseGrowthRow("{}", "abc", &read));
  EXPECT_FALSE(ParseGrowthRow("not json", "abc", &read));
}

TEST(GrowthBench, RefusesRepeatedNumbers) {
  GrowthOptions options;
  options.photos = {10, 10};
  comm::SingleCommunicator comm;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { RunGrowthBench(comm, options); }).find("--photos"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::bench
