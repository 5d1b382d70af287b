#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/study/priors_parts.h"
#include "core/base/errors.h"

namespace skyquilt::bench {
namespace {

// nmad_m: of roofs; walls have twice as much.
VariantResult Trained(double psnr_db, double nmad_m, int64_t steps) {
  VariantResult r;
  r.psnr_db = psnr_db;
  r.fields = {{.name = "context", .steps = 1'000'000}, {.name = "r0c0", .steps = steps - 100}, {.name = "r0c1", .steps = steps + 100}};
  r.classes = {{.name = "roof", .pixels = 10, .depth_nmad_m = nmad_m, .normal_median_deg = 20.0},
               {.name = "wall", .pixels = 10, .depth_nmad_m = 2.0 * nmad_m}};
  return r;
}

std::vector<PriorResults> ExampleResults() {
  return {{.name = "none", .label = "none", .seeds = {Trained(25.0, 0.1, 1000), Trained(27.0, 0.3, 1000)}},
          {.name = "planar", .label = "planar 0.03", .seeds = {Trained(25.5, 0.08, 900), Trained(26.5, 0.12, 700)}}};
}

const PriorFigure& FigureOf(const std::string& title) {
  return *std::find_if(PriorFigures().begin(), PriorFigures().end(), [&](const PriorFigure& f) { return f.title == title; });
}

size_t ColumnOf(const BenchTable& table, const std::string& title) {
  return static_cast<size_t>(std::find(table.columns.begin(), table.columns.end(), title) - table.columns.begin());
}

std::string ValueOf(const PriorVariant& variant, const std::string& key) {
  const auto at = std::find_if(variant.overrides.begin(), variant.overrides.end(), [&](const config::Override& o) { return o.key == key; });
  return at == variant.overrides.end() ? "not set" : at->value;
}

TEST(PriorVariants, HaveNoneFirstAndOneWeightEach) {
  const std::vector<PriorVariant> variants = PriorVariants({"default", "points", "planar"});
  ASSERT_EQ(variants.size(), 4U);
  EXPECT_EQ(variants[0].name, "none");
  EXPECT_EQ(variants[1].name, "planar");
  EXPECT_EQ(variants[2].name, "points");
  EXPECT_EQ(variants[3].name, "default");
  for (const StudiedPrior& prior : StudiedPriors()) {
    const std::string key = "priors." + prior.name;
    EXPECT_EQ(ValueOf(variants[0], key), "0") << "off even where the settings have it on";
    EXPECT_EQ(std::stod(ValueOf(variants[1], key)), prior.name == "planar" ? prior.weight : 0.0) << key;
    EXPECT_EQ(std::stod(ValueOf(variants[2], key)), prior.name == "points" ? prior.weight : 0.0) << key;
  }
  EXPECT_TRUE(variants[3].overrides.empty());
  EXPECT_THROW(PriorVariants({"plane"}), base::UsageError);
}

TEST(PriorVariants, OfAllHaveEveryWeight) {
  const std::vector<PriorVariant> variants = PriorVariants(PriorVariantNames());
  EXPECT_EQ(variants.size(), StudiedPriors().size() + 3);
  const auto all = std::find_if(variants.begin(), variants.end(), [](const PriorVariant& v) { return v.name == "all"; });
  ASSERT_NE(all, variants.end());
  for (const StudiedPrior& prior : StudiedPriors()) {
    EXPECT_GT(prior.weight, 0.0) << prior.name;
    EXPECT_EQ(std::stod(ValueOf(*all, "priors." + prior.name)), prior.weight);
  }
}

TEST(PriorTable, HasMediansOverSeedsAndNoColumnsWithoutNumbers) {
  const BenchTable table = PriorTable(ExampleResults(), "");
  ASSERT_EQ(table.rows.size(), 2U);
  for (const auto& row : table.rows) ASSERT_EQ(row.size(), table.columns.size());
  EXPECT_NEAR(table.rows[0][ColumnOf(table, "PSNR")].value, 26.0, 1e-12);
  EXPECT_NEAR(table.rows[0][ColumnOf(table, "roofs, NMAD")].value, 0.2, 1e-12);
  EXPECT_NEAR(table.rows[1][ColumnOf(table, "walls, NMAD")].value, 0.2, 1e-12);
  EXPECT_NEAR(table.rows[1][ColumnOf(table, "steps")].value, 800.0, 1e-9) << "the context does not count";
  for (const char* unmeasured : {"trees, NMAD", "walls, normals", "flat roofs, rms", "kept points, NMAD", "SSIM"}) {
    EXPECT_EQ(ColumnOf(table, unmeasured), table.columns.size()) << unmeasured;
  }
}

TEST(PriorTable, OfARealSurveyHasNoClasses) {
  std::vector<PriorResults> results = ExampleResults();
  for (PriorResults& of : results) {
    for (VariantResult& r : of.seeds) {
      r.classes.clear();
      r.kept_nmad_gsd = of.name == "none" ? 4.0 : 3.0;
    }
  }
  EXPECT_EQ(PriorTable(results, "").columns, (std::vector<std::string>{"variant", "steps", "PSNR", "kept points, NMAD"}));
  EXPECT_NEAR(ChangeOf(results[0], results[1], FigureOf("kept points, NMAD")).difference.median, -25.0, 1e-9);
  EXPECT_EQ(PriorCharts(results).size(), 1U);
}

TEST(ChangeOf, IsInPercentOrInTheUnitWithTheRangeOverSeeds) {
  const std::vector<PriorResults> results = ExampleResults();
  const PriorChange nmad = ChangeOf(results[0], results[1], FigureOf("roofs, NMAD"));
  EXPECT_NEAR(nmad.difference.median, -40.0, 1e-9) << "of the changes of each seed";
  EXPECT_NEAR(nmad.lowest, -60.0, 1e-9);
  EXPECT_NEAR(nmad.highest, -20.0, 1e-9);
  EXPECT_EQ(nmad.difference.pairs, 2);
  EXPECT_TRUE(std::isnan(nmad.difference.noise)) << "unknown for two trainings";
  const PriorChange psnr = ChangeOf(results[0], results[1], FigureOf("PSNR"));
  EXPECT_NEAR(psnr.difference.median, 0.0, 1e-12);
  EXPECT_EQ(psnr.difference.noise, kNoise_db);
  EXPECT_NEAR(psnr.lowest, -0.5, 1e-12);
  EXPECT_NEAR(psnr.highest, 0.5, 1e-12);
  EXPECT_NEAR(ChangeOf(results[0], results[1], FigureOf("steps")).difference.median, -20.0, 1e-9);
  EXPECT_NEAR(ChangeOf(results[0], results[1], FigureOf("roofs, normals")).difference.median, 0.0, 1e-12);
  EXPECT_EQ(ChangeOf(results[0], results[1], FigureOf("trees, NMAD")).difference.pairs, 0);
  EXPECT_TRUE(std::isnan(ChangeOf(results[0], results[1], FigureOf("trees, NMAD")).difference.median));
}

TEST(ChangeOf, ComparesOnlySeedsThatBothHave) {
  std::vector<PriorResults> results = ExampleResults();
  VariantResult failed;
  failed.failure = "no memory";
  results[1].seeds[1] = failed;
  const PriorChange nmad = ChangeOf(results[0], results[1], FigureOf("roofs, NMAD"));
  EXPECT_NEAR(nmad.difference.median, -20.0, 1e-9) << "the other town is harder and must not count on one side only";
  EXPECT_EQ(nmad.difference.pairs, 1);
  EXPECT_NE(PriorTable(results, "").rows[1][0].shown.find("no memory"), std::string::npos);
}

TEST(PriorChangeTable, LeavesOutTheReferenceAndWhatHasNoChange) {
  const BenchTable table = PriorChangeTable(ExampleResults(), "changes");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_EQ(table.rows[0].size(), table.columns.size());
  EXPECT_EQ(ColumnOf(table, "training"), table.columns.size());
  EXPECT_EQ(table.rows[0][ColumnOf(table, "roofs, NMAD")].shown, "-40.0 % (-60.0 to -20.0)");
  EXPECT_EQ(table.rows[0][ColumnOf(table, "PSNR")].shown, "0.00 dB (-0.50 to +0.50)");
}

TEST(PriorTrainingTable, HasARowForEveryTraining) {
  std::vector<PriorResults> results = ExampleResults();
  for (PriorResults& of : results) {
    for (size_t i = 0; i < of.seeds.size(); ++i) of.seeds[i].label = of.label + ", seed " + std::to_string(i + 11);
  }
  const BenchTable table = PriorTrainingTable(results, "trainings");
  ASSERT_EQ(table.rows.size(), 4U);
  for (const auto& row : table.rows) ASSERT_EQ(row.size(), table.columns.size());
  EXPECT_EQ(table.rows[3][0].shown, "planar 0.03, seed 12");
  EXPECT_NEAR(table.rows[3][ColumnOf(table, "roofs, NMAD")].value, 0.12, 1e-12);
}

TEST(PriorVerdicts, TellTheChangesOfEachVariant) {
  const std::vector<std::string> verdicts = PriorVerdicts(ExampleResults());
  ASSERT_EQ(verdicts.size(), 2U);
  EXPECT_EQ(verdicts[0],
            "'planar 0.03' against 'none': steps -20.0 %; PSNR no difference seen (0.00 dB, noise up to 0.3 dB); roofs, NMAD -40.0 %; "
            "walls, NMAD -40.0 %.");
  EXPECT_NE(verdicts[1].find("Three seeds"), std::string::npos) << verdicts[1];
  EXPECT_TRUE(PriorVerdicts({ExampleResults().front()}).empty());
}

TEST(PriorVerdicts, OfThreeSeedsLeaveOutWhatIsNoMoreThanNoise) {
  const std::vector<PriorResults> results = {
      {.name = "none", .label = "none", .seeds = {Trained(25.0, 0.10, 1000), Trained(27.0, 0.20, 1000), Trained(26.0, 0.30, 1000)}},
      {.name = "planar", .label = "planar", .seeds = {Trained(25.2, 0.15, 900), Trained(27.2, 0.15, 890), Trained(26.2, 0.28, 910)}}};
  const std::vector<std::string> verdicts = PriorVerdicts(results);
  ASSERT_EQ(verdicts.size(), 1U) << "the noise of all figures is known";
  EXPECT_NE(verdicts[0].find("steps -10.0 %; PSNR +0.20 dB; roofs, NMAD no difference seen (-6.7 %, noise up to"), std::string::npos) << verdicts[0];
}

TEST(PriorVerdicts, CompareOverCommonPixelsWhereTheyWereScored) {
  std::vector<PriorResults> results = ExampleResults();
  for (PriorResults& of : results) {
    for (VariantResult& r : of.seeds) r.psnr_common_db = of.name == "none" ? 20.0 : 21.0;
  }
  const std::string verdict = PriorVerdicts(results)[0];
  EXPECT_NE(verdict.find("PSNR, common +1.00 dB;"), std::string::npos) << verdict;
  EXPECT_EQ(verdict.find("PSNR no"), std::string::npos) << verdict;
}

}  // namespace
}  // namespace skyquilt::bench
