#include "bench/study/buildings_pool.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/study/buildings_parts.h"
#include "core/base/errors.h"
#include "core/base/random.h"

namespace skyquilt::bench {
namespace {

using evaluate::buildings::BuildingOutcome;
using Fate = BuildingOutcome::Fate;

BuildingOutcome Matched(double area_m2, double length_error_m, double sigma_m, const std::string& roof = "flat") {
  return {.fate = Fate::kMatched,
          .truth_id = 0,
          .found_id = 1,
          .roof = roof,
          .roof_found = roof,
          .area_m2 = area_m2,
          .overlap = 0.9,
          .errors = {{"length", length_error_m, sigma_m}}};
}

VariantResult Town(std::vector<BuildingOutcome> each, double gsd_m) {
  VariantResult town;
  town.buildings.emplace().gsd_m = gsd_m;
  town.buildings->truth.emplace().each = std::move(each);
  return town;
}

std::vector<BuildingOutcome> Same(int n, const BuildingOutcome& outcome) {
  return std::vector<BuildingOutcome>(static_cast<size_t>(n), outcome);
}

TEST(PoolBuildings, CountsBuildingsAndNotTowns) {
  // One error of 3 m in a small town and 99 of 0.1 m in a large one: the mean of both towns' RMSE would be 1.55 m.
  const std::vector<VariantResult> towns = {Town({Matched(80, 3.0, 1.0)}, 0.1), Town(Same(99, Matched(80, 0.1, 1.0)), 0.2), VariantResult()};
  const BuildingPool pool = PoolBuildings(towns);
  ASSERT_EQ(pool.size(), 100U);
  EXPECT_NEAR(PooledErrors(pool, "length").rmse, std::sqrt((9.0 + 99 * 0.01) / 100.0), 1e-12);
  EXPECT_NEAR(PooledErrors(pool, "length", true).rmse, std::sqrt((900.0 + 99 * 0.25) / 100.0), 1e-12) << "each by its own ground sampling distance";
  EXPECT_EQ(PooledErrors(pool, "length").within_sigma, 0.99);
  EXPECT_EQ(PooledErrors(pool, "length", true).within_sigma, 0.99) << "the unit does not matter";
  EXPECT_EQ(PooledErrors(pool, "width").n, 0);
}

TEST(PoolBuildings, SharesAreOfTheirOwnBuildings) {
  std::vector<BuildingOutcome> each = Same(6, Matched(80, 0.0, 1.0));
  each.push_back({.fate = Fate::kMissed, .truth_id = 5, .roof = "hip", .area_m2 = 30});
  each.push_back({.fate = Fate::kInvented, .found_id = 7, .roof_found = "flat", .area_m2 = 9});
  each.push_back({.fate = Fate::kInvented, .found_id = 8, .roof_found = "flat", .area_m2 = 90});
  each[0].roof_found = "other";
  const std::vector<VariantResult> towns = {Town(each, 0.1)};
  const BuildingPool pool = PoolBuildings(towns);
  EXPECT_DOUBLE_EQ(Completeness(pool), 6.0 / 7.0);
  EXPECT_DOUBLE_EQ(Correctness(pool), 6.0 / 8.0);
  EXPECT_DOUBLE_EQ(Quality(pool), 6.0 / 9.0);
  EXPECT_DOUBLE_EQ(RoofKindRight(pool), 5.0 / 6.0);
  const BuildingPool small = OfSize(pool, 0, 50), large = OfSize(pool, 50, 1e9);
  EXPECT_EQ(small.size() + large.size(), pool.size());
  EXPECT_EQ(Count(small).invented, 1);
  EXPECT_EQ(Completeness(small), 0.0);
  EXPECT_EQ(Completeness(large), 1.0);
  EXPECT_TRUE(std::isnan(Completeness({})));
}

TEST(Bootstrap, IntervalsOfSharesAreThoseOfTheBinomial) {
  std::vector<BuildingOutcome> each = Same(180, Matched(80, 0.0, 1.0));
  for (int i = 0; i < 20; ++i) each.push_back({.fate = Fate::kMissed, .truth_id = i, .roof = "flat", .area_m2 = 80});
  const std::vector<VariantResult> towns = {Town(each, 0.1)};
  const PooledFigure share = Bootstrap(PoolBuildings(towns), Completeness);
  const double sigma = std::sqrt(0.9 * 0.1 / 200.0);
  EXPECT_DOUBLE_EQ(share.value, 0.9);
  EXPECT_NEAR(share.low, 0.9 - 1.96 * sigma, 0.3 * sigma);
  EXPECT_NEAR(share.high, 0.9 + 1.96 * sigma, 0.3 * sigma);
}

TEST(Bootstrap, IntervalsHoldTheFigureAndShrinkWithMoreBuildings) {
  base::Random random(5);
  double width_before = 1e9;
  for (const int n : {20, 320}) {
    std::vector<BuildingOutcome> each;
    for (int i = 0; i < n; ++i) each.push_back(Matched(80, 0.3 * random.Normal(), 0.3));
    const std::vector<VariantResult> towns = {Town(each, 0.1)};
    const PooledFigure rmse = Bootstrap(PoolBuildings(towns), [](const BuildingPool& drawn) { return PooledErrors(drawn, "length").rmse; });
    EXPECT_LT(rmse.low, rmse.value);
    EXPECT_GT(rmse.high, rmse.value);
    EXPECT_LT(rmse.high - rmse.low, 0.5 * width_before) << "16 times as many buildings, a quarter of the width";
    width_before = rmse.high - rmse.low;
  }
}

TEST(Bootstrap, IsRepeatableAndNothingWithoutBuildings) {
  std::vector<BuildingOutcome> each;
  for (int i = 0; i < 12; ++i) each.push_back(Matched(80, 0.1 * i, 1.0));
  const std::vector<VariantResult> towns = {Town(each, 0.1)}, single = {Town(Same(1, Matched(80, 0.5, 1.0)), 0.1)};
  const auto bias = [](const BuildingPool& drawn) { return PooledErrors(drawn, "length").bias; };
  const PooledFigure once = Bootstrap(PoolBuildings(towns), bias), again = Bootstrap(PoolBuildings(towns), bias);
  EXPECT_EQ(once.low, again.low);
  EXPECT_EQ(once.high, again.high);
  const PooledFigure one = Bootstrap(PoolBuildings(single), bias);
  EXPECT_EQ(one.value, 0.5);
  EXPECT_TRUE(std::isnan(one.low) && std::isnan(one.high)) << "one building says nothing of others";
  EXPECT_TRUE(std::isnan(Bootstrap({}, bias).value));
}

std::vector<BuildingsResults> TwoVariants() {
  std::vector<BuildingOutcome> good = Same(60, Matched(80, 0.05, 0.05)), bad = Same(30, Matched(80, 0.5, 0.05));
  for (int i = 0; i < 30; ++i) bad.push_back({.fate = Fate::kMissed, .truth_id = i, .roof = "flat", .area_m2 = 80});
  return {{.name = "truth", .label = "true depth", .towns = {Town(good, 0.1), Town(good, 0.1)}},
          {.name = "field", .label = "field", .towns = {Town(bad, 0.1), Town(bad, 0.1)}}};
}

size_t ColumnNamed(const BenchTable& table, const std::string& title) {
  return static_cast<size_t>(std::find(table.columns.begin(), table.columns.end(), title) - table.columns.begin());
}

TEST(BuildingsTables, HaveTheirRowsAndFullOnes) {
  std::vector<BuildingsResults> results = TwoVariants();
  results[1].towns.push_back(VariantResult());
  results[1].towns.back().failure = "no memory";
  const BenchTable found = BuildingsTable(results, ""), sizes = BuildingsSizeTable(results, "sizes"),
                   measures = BuildingsMeasureTable(results, "measures"), towns = BuildingsTownTable(results, "towns");
  EXPECT_EQ(found.rows.size(), 2U);
  EXPECT_EQ(sizes.rows.size(), 2U * 3U);
  EXPECT_EQ(measures.rows.size(), 2U) << "only the length was measured";
  EXPECT_EQ(towns.rows.size(), 5U);
  for (const BenchTable* table : {&found, &sizes, &measures, &towns}) {
    for (const auto& row : table->rows) EXPECT_EQ(row.size(), table->columns.size());
  }
  EXPECT_EQ(found.rows[1][ColumnNamed(found, "completeness")].value, 0.5);
  EXPECT_NE(found.rows[1][0].shown.find("no memory"), std::string::npos);
  EXPECT_NEAR(measures.rows[1][ColumnNamed(measures, "RMSE in GSD")].value, 5.0, 1e-9);
  EXPECT_EQ(ColumnNamed(towns, "deck RMSE"), towns.columns.size()) << "nothing has a deck";
  EXPECT_EQ(BuildingsCharts(results).size(), 1U);
}

TEST(BuildingsVerdicts, TellWhichTargetsAreMet) {
  const std::vector<std::string> verdicts = BuildingsVerdicts(TwoVariants());
  ASSERT_EQ(verdicts.size(), 2U) << "120 buildings are enough";
  EXPECT_NE(
      verdicts[0].find("'true depth' reaches: completeness over 50 m\xC2\xB2 100.0 %; correctness over 50 m\xC2\xB2 100.0 %; length RMSE 0.50 GSD"),
      std::string::npos)
      << verdicts[0];
  EXPECT_NE(verdicts[1].find("Not: completeness over 50 m\xC2\xB2 50.0 %; length RMSE 5.00 GSD; 0.0 % of errors within 1.96 sigma."),
            std::string::npos)
      << verdicts[1];
  std::vector<BuildingsResults> few = TwoVariants();
  for (BuildingsResults& of : few) of.towns.resize(1);
  EXPECT_NE(BuildingsVerdicts(few).back().find("60 true building(s)"), std::string::npos);
  EXPECT_TRUE(BuildingsVerdicts({{.name = "field", .label = "field", .towns = {VariantResult()}}}).empty());
}

TEST(BuildingsVariants, StandInOneOrderAndDiffer) {
  const std::vector<BuildingsVariant> chosen = BuildingsVariants({"nadir", "truth", "no_priors"});
  ASSERT_EQ(chosen.size(), 3U);
  EXPECT_EQ(chosen[0].source, SurfaceSource::kTruth);
  EXPECT_EQ(chosen[1].name, "no_priors");
  EXPECT_FALSE(chosen[1].training.overrides.empty());
  EXPECT_LT(chosen[2].training.max_tilt_deg, 30.0);
  EXPECT_FALSE(chosen[2].obliques);
  EXPECT_THROW(BuildingsVariants({"lidar"}), base::UsageError);
  EXPECT_EQ(BuildingsVariants(BuildingsVariantNames()).size(), BuildingsVariantNames().size());
}

}  // namespace
}  // namespace skyquilt::bench
