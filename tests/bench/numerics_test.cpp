#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "bench/numerics/geodesy.h"
#include "bench/numerics/numerics_bench.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/progress.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

class Numerics : public ::testing::Test {
 protected:
  void SetUp() override { base::Progress::SetQuiet(true); }
  void TearDown() override { base::Progress::SetQuiet(false); }
  // The rows of the group; all that are judged must have passed.
  static std::vector<NumericRow> RunPassing(const NumericGroup& group) {
    const NumericsResult result = RunNumerics({group}, true);
    for (const NumericRow& row : result.Failed()) {
      ADD_FAILURE() << row.group << ": " << row.name << ": expected " << row.expected << "; seen " << row.seen << ", worst " << row.worst;
    }
    EXPECT_NO_THROW(ThrowIfFailed(result));
    return result.groups.at(0).rows;
  }
  static NumericCase CaseOf(double limit, const CaseResult& finding) {
    return {.name = "one", .expected = "little", .unit = "mm", .limit = limit, .run = [finding] { return finding; }};
  }
  TemporaryFolder folder_;
  NumericsOptions quick_{.quick = true, .silent = true, .threads = 1, .work_folder = folder_.path()};
};

TEST_F(Numerics, ACasePassesOnlyWithinItsLimitAndWhenAllHolds) {
  EXPECT_EQ(RunCase("g", CaseOf(1.0, {.worst = 1.0})).verdict, Verdict::kPassed);
  EXPECT_EQ(RunCase("g", CaseOf(1.0, {.worst = 1.0001})).verdict, Verdict::kFailed);
  EXPECT_EQ(RunCase("g", CaseOf(1.0, {.worst = 0.5, .holds = false})).verdict, Verdict::kFailed);
  EXPECT_EQ(RunCase("g", CaseOf(1.0, {.worst = kNoNumber})).verdict, Verdict::kFailed);
  EXPECT_EQ(RunCase("g", CaseOf(kNoNumber, {.worst = kNoNumber})).verdict, Verdict::kPassed);
  NumericCase thrown = CaseOf(1.0, {});
  thrown.run = []() -> CaseResult { throw std::logic_error("out of range"); };
  const NumericRow row = RunCase("g", thrown);
  EXPECT_EQ(row.verdict, Verdict::kFailed);
  EXPECT_NE(row.seen.find("out of range"), std::string::npos);
  thrown.run = []() -> CaseResult { throw base::Interrupted(); };
  EXPECT_THROW(RunCase("g", thrown), base::Interrupted);
  NumericCase shown = CaseOf(1.0, {.worst = 50.0});
  shown.for_comparison = true;
  EXPECT_EQ(RunCase("g", shown).verdict, Verdict::kShown);
}

TEST_F(Numerics, NanStaysTheWorst) {
  Worst worst;
  worst.Take(3.0);
  worst.Take(kNoNumber);
  worst.Take(5.0);
  EXPECT_TRUE(std::isnan(worst.value()));
}

TEST_F(Numerics, AFailedCaseIsInTheTableAndEndsTheCommand) {
  NumericGroup group{.id = "space", .title = "Space", .cases = {CaseOf(1.0, {.seen = "far off", .worst = 7.0}), CaseOf(1.0, {.worst = 0.1})}};
  const NumericsResult result = RunNumerics({group}, true);
  EXPECT_EQ(result.Count(Verdict::kFailed), 1);
  EXPECT_EQ(result.Count(Verdict::kPassed), 1);
  const std::string error = ErrorOf<base::FailedCheck>([&] { ThrowIfFailed(result); });
  EXPECT_NE(error.find("far off"), std::string::npos);
  const BenchPage page = NumericsPage(result, "skyquilt bench numerics");
  EXPECT_NE(BenchText(page).find("FAILED"), std::string::npos);
  EXPECT_NE(BenchHtml(page).find("1 of 2"), std::string::npos);
  const nlohmann::json json = base::ParseJson(NumericsJson(result, "skyquilt bench numerics"));
  EXPECT_EQ(json.at("failed"), 1);
  EXPECT_EQ(json.at("rows").at(0).at("verdict"), "failed");
  EXPECT_EQ(json.at("rows").at(1).at("worst"), 0.1);
}

TEST_F(Numerics, LongDoubleGeodesyHasTheEllipsoidsRadii) {
  // Polar and equatorial radii of WGS84; 15 km north of the equator is 0.13565 degrees.
  EXPECT_NEAR(static_cast<double>(EcefOf({90.0, 0.0, 0.0}).z()), 6356752.314245, 1e-6);
  EXPECT_NEAR(static_cast<double>(EcefOf({0.0, 90.0, 10.0}).y()), 6378147.0, 1e-9);
  EXPECT_LT(NaiveErrorMetres(NaiveFrame::kEnu, {47.0, 8.0, 400.0}, {47.0, 8.0, 400.0}), 1e-9);
  EXPECT_GT(NaiveErrorMetres(NaiveFrame::kEcef, {47.0, 8.0, 400.0}, {47.1234567, 8.7654321, 412.3}), 1e-3);
}

TEST_F(Numerics, EveryGroupPasses) {
  const std::pair<NumericGroup, size_t> groups[] = {
      // and their least numbers of rows
      {SpaceGroup(quick_), 20},  {PlaceGroup(quick_), 30}, {RayGroup(quick_), 0},     {CompositeGroup(quick_), 0}, {FieldGroup(quick_), 0},
      {TrainerGroup(quick_), 0}, {ConesGroup(quick_), 80}, {PriorsGroup(quick_), 45}, {NonFiniteGroup(quick_), 0}, {BrightnessGroup(quick_), 0}};
  for (const auto& [group, least] : groups) EXPECT_GE(RunPassing(group).size(), least) << group.id;
}

TEST_F(Numerics, LeavesOutThePipelineWithoutRanks) {
  for (const NumericGroup& group : AllGroups(quick_)) EXPECT_NE(group.id, "earth");
}

}  // namespace
}  // namespace skyquilt::bench
