#include "bench/rank_shares.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <tuple>

#include "coordinator/project/project.h"
#include "coordinator/project/stamp.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/scene/train_report.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

MeasuredRun SampleRun(int blocks) {
  MeasuredRun run;
  run.stages = {{"prepare", 30.0, 0.0}, {"train: context", 20.0, 0.0}, {"evaluate", 10.0, 120.0}};
  run.block_seconds.assign(static_cast<size_t>(blocks), 60.0);
  return run;
}

RankShareOptions EvenRanks(std::vector<int> ranks) {
  base::Progress::SetQuiet(true);
  return {.ranks = std::move(ranks), .cost_error = 0.0, .speed_spread = 0.0};
}

TEST(ShareAmongRanks, DividesRaysAndBlocksAndNothingElse) {
  const RankShares shares = ShareAmongRanks(SampleRun(6), EvenRanks({1, 2, 4, 7}));
  ASSERT_EQ(shares.rows.size(), 4U);
  for (const RankShareRow& row : shares.rows) EXPECT_DOUBLE_EQ(row.own_s, 60.0);
  EXPECT_DOUBLE_EQ(shares.rows[0].WallSeconds(), 60.0 + 120.0 + 360.0);
  // Rank 0 has no part in it: two ranks are as fast as one.
  EXPECT_NEAR(shares.rows[1].WallSeconds(), shares.rows[0].WallSeconds(), 5.0);
  EXPECT_DOUBLE_EQ(shares.rows[2].divided_s, 40.0);
  EXPECT_NEAR(shares.rows[2].blocks_s, 120.0, 5.0);
  EXPECT_NEAR(shares.rows[3].blocks_s, 60.0, 5.0);
  EXPECT_NEAR(shares.rows[3].Share(), 60.0 / (60.0 + 20.0 + 60.0), 0.03);
}

TEST(ShareAmongRanks, NoMoreRanksTrainThanThereAreBlocks) {
  const RankShares few = ShareAmongRanks(SampleRun(2), EvenRanks({64}));
  EXPECT_NEAR(few.rows[0].blocks_s, 60.0, 5.0);
  RankShareOptions larger = EvenRanks({64});
  larger.blocks = 126;
  const RankShares many = ShareAmongRanks(SampleRun(2), larger);
  EXPECT_EQ(many.run.block_seconds.size(), 126U);
  EXPECT_DOUBLE_EQ(many.rows[0].own_s, 63.0 * few.rows[0].own_s);
  EXPECT_NEAR(many.rows[0].blocks_s, 120.0, 5.0);
}

TEST(ShareAmongRanks, RefusesNumbersOutOfRange) {
  EXPECT_NE(ErrorOf<base::UsageError>([] { ShareAmongRanks(SampleRun(2), EvenRanks({4, 4})); }).find("--rank-counts"), std::string::npos);
  EXPECT_NE(ErrorOf<base::UsageError>([] { ShareAmongRanks(SampleRun(2), EvenRanks({})); }).find("--rank-counts"), std::string::npos);
  RankShareOptions options = EvenRanks({2});
  options.blocks = -1;
  EXPECT_NE(ErrorOf<base::UsageError>([&] { ShareAmongRanks(SampleRun(2), options); }).find("--blocks"), std::string::npos);
}

void WriteProject(const coordinator::Project& project, int ranks) {
  scene::TrainReport report;
  report.ranks = ranks;
  report.fields = {{.name = "context", .block = -1, .ok = true, .seconds = 20.0},
                   {.name = "r0c0", .block = 0, .ok = true, .seconds = 30.0},
                   {.name = "r0c1", .block = 1, .ok = true, .seconds = 40.0},
                   {.name = "r0c2", .block = 2, .ok = false, .seconds = 5.0}};
  scene::WriteTrainReport(report, project.TrainReport());
  for (const auto& [stage, seconds, rendering_s] : {std::tuple{"train", 100.0, 0.0}, std::tuple{"evaluate", 50.0, 35.0}}) {
    coordinator::SaveStamp(
        project,
        {.stage = stage, .state = coordinator::StageStamp::kDone, .options = {}, .inputs = {}, .seconds = seconds, .rendering_seconds = rendering_s});
  }
  coordinator::SaveStamp(project, {.stage = "surface", .state = coordinator::StageStamp::kRunning, .options = {}, .inputs = {}, .seconds = 7.0});
}

TEST(ReadMeasuredRun, TakesTheTimesOfFinishedStages) {
  const TemporaryFolder folder;
  const coordinator::Project project = coordinator::Project::Create(folder.path());
  WriteProject(project, 1);
  const MeasuredRun run = ReadMeasuredRun(project.folder);
  EXPECT_EQ(run.block_seconds, (std::vector<double>{30.0, 40.0}));
  ASSERT_EQ(run.stages.size(), 3U) << "an unfinished stage counts";
  EXPECT_DOUBLE_EQ(run.stages[0].own_s, 10.0) << "set-up: the stage without its fields";
  EXPECT_EQ(run.stages[1].name, "train: context");
  EXPECT_DOUBLE_EQ(run.stages[1].own_s, 20.0);
  EXPECT_EQ(run.stages[2].name, "evaluate");
  EXPECT_DOUBLE_EQ(run.stages[2].own_s, 15.0);
  EXPECT_DOUBLE_EQ(run.stages[2].divided_s, 35.0);
}

TEST(ReadMeasuredRun, RefusesTimesOfSeveralRanks) {
  const TemporaryFolder folder;
  const coordinator::Project project = coordinator::Project::Create(folder.path());
  WriteProject(project, 4);
  EXPECT_NE(ErrorOf<base::InputError>([&] { ReadMeasuredRun(project.folder); }).find("4 ranks"), std::string::npos);
}

TEST(RankSharesPage, SaysWhetherRankZeroIsInTheWay) {
  const BenchPage missed = RankSharesPage(ShareAmongRanks(SampleRun(6), EvenRanks({2, 16})), "skyquilt bench schedule --stages out");
  ASSERT_EQ(missed.verdicts.size(), 1U);
  EXPECT_TRUE(missed.verdicts[0].starts_with("Missed")) << missed.verdicts[0];
  EXPECT_NE(missed.verdicts[0].find("'prepare' with 50 %"), std::string::npos) << missed.verdicts[0];
  MeasuredRun quick = SampleRun(150);
  for (StageWork& stage : quick.stages) stage.own_s *= 0.5;
  EXPECT_TRUE(RankSharesPage(ShareAmongRanks(quick, EvenRanks({16})), "").verdicts[0].starts_with("Met"));
  EXPECT_TRUE(RankSharesPage(ShareAmongRanks(quick, EvenRanks({4})), "").verdicts.empty());
}

}  // namespace
}  // namespace skyquilt::bench
