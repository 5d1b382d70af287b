#include "coordinator/planning/run_ledger.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <memory>
#include <thread>

#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::coordinator {
namespace {

class LedgerOfRun : public testing::Test {
 protected:
  std::unique_ptr<RunLedger> Open() {
    return std::make_unique<RunLedger>(
        Project{folder_.path()}, [this] { return now_s_; }, 0.0);
  }

  TemporaryFolder folder_;
  double now_s_ = 1000.0;
};

TEST_F(LedgerOfRun, TimePassesOnlyAfterTheStart) {
  const auto ledger = Open();
  now_s_ += 7.0;
  EXPECT_EQ(ledger->UsedSeconds(), 0.0);
  ledger->Start();
  now_s_ += 3.0;
  EXPECT_EQ(ledger->UsedSeconds(), 3.0);
}

TEST_F(LedgerOfRun, TheTimeOfEarlierRunsCounts) {
  {
    const auto first = Open();
    first->Start();
    first->SetPlanned("prepare", 8.0);
    now_s_ += 2.0;
    first->Decide("prepare", 9.0, {{"prepare.max_features", "2048"}});
    first->Begin("prepare");
    now_s_ += 5.0;
    first->End("prepare");
    first->Decide("train", 60.0, {{"run.time_budget_s", "58.000"}});
    first->Begin("train");
    first->SetGivenUp("train", {{"previews", "train", "no previews"}});
    now_s_ += 20.0;
  }
  now_s_ += 500.0;  // nothing ran
  const auto second = Open();
  second->Start();
  EXPECT_EQ(second->UsedSeconds(), 27.0);
  const StageRecord prepare = second->Of("prepare");
  EXPECT_TRUE(prepare.begun && prepare.done);
  EXPECT_EQ(prepare.took_s, 5.0);
  EXPECT_EQ(prepare.planned_s, 8.0);
  EXPECT_EQ(prepare.predicted_s, 9.0);
  const StageRecord train = second->Of("train");
  EXPECT_TRUE(train.begun && !train.done && std::isnan(train.planned_s));
  EXPECT_EQ(train.took_s, 20.0);
  // Beginning once more keeps what was decided.
  second->Decide("train", 30.0, {});
  second->Begin("train");
  now_s_ += 4.0;
  second->End("train");
  EXPECT_EQ(second->Of("train").took_s, 24.0);
  ASSERT_EQ(second->Of("train").changes.size(), 1U);
  EXPECT_EQ(second->Of("train").changes.front().value, "58.000");
  ASSERT_EQ(second->AllGivenUp().size(), 1U);
  EXPECT_EQ(second->UsedSeconds(), 31.0);
}

TEST_F(LedgerOfRun, DecidingAgainReplacesWhatWasGivenUp) {
  const auto ledger = Open();
  ledger->Start();
  ledger->SetGivenUp("surface", {{"surface", "surface", "none"}});
  ledger->SetGivenUp("evaluate", {{"scores", "evaluate", "6 of 20"}});
  ledger->SetGivenUp("surface", {});
  ASSERT_EQ(ledger->AllGivenUp().size(), 1U);
  EXPECT_EQ(ledger->AllGivenUp().front().what, "scores");
}

TEST_F(LedgerOfRun, ADamagedFileIsLeftAside) {
  std::filesystem::create_directories(folder_.path() / ".state");
  base::WriteFileAtomically(RunLedger::FileOf(Project{folder_.path()}), "{\"used_s\": 12");
  const auto ledger = Open();
  EXPECT_TRUE(ledger->Stages().empty());
  EXPECT_EQ(ledger->UsedSeconds(), 0.0);
}

TEST_F(LedgerOfRun, ForgetsForARestart) {
  {
    const auto ledger = Open();
    ledger->Start();
    ledger->Decide("prepare", 1.0, {});
    ledger->Begin("prepare");
    now_s_ += 2.0;
  }
  const auto ledger = Open();
  EXPECT_EQ(ledger->UsedSeconds(), 2.0);
  ledger->Forget();
  EXPECT_EQ(ledger->UsedSeconds(), 0.0);
  EXPECT_FALSE(std::filesystem::exists(RunLedger::FileOf(Project{folder_.path()})));
}

// With a clock of its own: what a kill would leave.
TEST(RunLedger, SavesByItselfWhileAStageRuns) {
  const TemporaryFolder folder;
  const Project project{folder.path()};
  const double now_s = 0.0;
  RunLedger ledger(
      project, [&now_s] { return now_s; }, 0.01);
  ledger.Start();
  ledger.Decide("train", 100.0, {});
  ledger.Begin("train");
  const std::filesystem::path file = RunLedger::FileOf(project);
  std::filesystem::remove(file);
  for (int i = 0; i < 500 && !std::filesystem::exists(file); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_TRUE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace skyquilt::coordinator
