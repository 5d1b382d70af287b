#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "coordinator/scheduler/train_ledger.h"
#include "coordinator/scheduler/training_log.h"
#include "core/base/file.h"
#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

class TrainingFiles : public testing::Test {
 protected:
  void SetUp() override {
    project_.folder = std::filesystem::temp_directory_path() /
                      ("skyquilt_training_files_" + std::to_string(getpid()) + "_" + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(project_.folder);
  }
  void TearDown() override { std::filesystem::remove_all(project_.folder); }

  static std::vector<int64_t> StepsIn(const std::filesystem::path& file) {
    std::vector<int64_t> steps;
    std::istringstream text(base::ReadFile(file));
    std::string line;
    std::getline(text, line);
    while (std::getline(text, line)) steps.push_back(std::stoll(line));
    return steps;
  }
  static worker::TrainStatus At(int64_t step) {
    worker::TrainStatus status;
    status.step = step;
    return status;
  }
  static FieldOutcome Outcome(int block, const std::string& name, int64_t steps, double seconds) {
    FieldOutcome outcome;
    outcome.job.block = block;
    outcome.job.name = name;
    outcome.result.ok = true;
    outcome.result.steps = steps;
    outcome.result.seconds = seconds;
    outcome.wall_s = seconds;
    return outcome;
  }

  Project project_;
};

TEST_F(TrainingFiles, LogContinuesFromTheCheckpointWithoutDoubleSteps) {
  const std::filesystem::path file = project_.TrainLog("context");
  {
    TrainingLog log(file, 0.0);
    for (const int64_t step : {0, 10, 20, 30}) log.Add(At(step));
  }
  {
    TrainingLog log(file, 0.0);  // killed after step 30, checkpoint of step 15
    log.Add(At(15));
    log.Add(At(25));
  }
  EXPECT_EQ(StepsIn(file), (std::vector<int64_t>{0, 10, 15, 25}));
}

TEST_F(TrainingFiles, LogKeepsFirstAndLastOfABurst) {
  const std::filesystem::path file = project_.TrainLog("context");
  {
    TrainingLog log(file, 3600.0);
    for (int64_t step = 0; step < 100; ++step) log.Add(At(step));
  }
  EXPECT_EQ(StepsIn(file), (std::vector<int64_t>{0, 99}));
}

TEST_F(TrainingFiles, LogOfACompleteFieldIsNotChanged) {
  const std::filesystem::path file = project_.TrainLog("context");
  { TrainingLog log(file); }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST_F(TrainingFiles, LedgerRemembersTheBudgetOfTheSameConfigurationOnly) {
  {
    TrainLedger ledger(project_, "aaaa");
    ledger.AssignSeconds("block_r0c0", 12.5);
    ledger.SetSpent(40.0, true);
  }
  const TrainLedger same(project_, "aaaa");
  EXPECT_DOUBLE_EQ(same.AssignedSeconds("block_r0c0"), 12.5);
  EXPECT_DOUBLE_EQ(same.AssignedSeconds("block_r0c1"), 0.0);
  EXPECT_DOUBLE_EQ(same.spent_s(), 40.0);
  const TrainLedger other(project_, "bbbb");
  EXPECT_DOUBLE_EQ(other.spent_s(), 0.0);
}

TEST_F(TrainingFiles, ReportKeepsTheFiguresOfFieldsThatWereAlreadyComplete) {
  {
    TrainLedger ledger(project_, "aaaa");
    FieldOutcome context = Outcome(-1, "context", 100, 30.0);
    context.peak_rss_bytes = 1000;
    ledger.AddOutcome(context);
  }
  TrainLedger ledger(project_, "aaaa");
  FieldOutcome again = Outcome(-1, "context", 100, 30.0);
  again.wall_s = 0.01;  // loaded, not trained
  ledger.AddOutcome(again);
  FieldOutcome failed = Outcome(0, "block_r0c0", 5, 1.0);
  failed.failure.kind = Failure::kBlock;
  failed.failure.reason = "diverged";
  ledger.AddOutcome(failed);
  ledger.SetSpent(31.0, true);
  scene::WriteTrainReport(ledger.Report(3, 2), project_.TrainReport());
  const nlohmann::json report = base::ParseJson(base::ReadFile(project_.TrainReport()));
  EXPECT_EQ(report.at("ranks"), 3);
  EXPECT_EQ(report.at("peak_rss_bytes"), 1000);
  ASSERT_EQ(report.at("fields").size(), 2U);
  EXPECT_EQ(report.at("fields")[0].at("name"), "context");
  EXPECT_DOUBLE_EQ(report.at("fields")[0].at("wall_seconds").get<double>(), 30.0);
  EXPECT_EQ(report.at("fields")[1].at("name"), "r0c0");
  EXPECT_FALSE(report.at("fields")[1].at("ok").get<bool>());
  EXPECT_EQ(report.at("fields")[1].at("reason"), "diverged");
}

TEST_F(TrainingFiles, DamagedLedgerIsReplaced) {
  std::filesystem::create_directories(project_.StateFolder());
  base::WriteFileAtomically(project_.StateFolder() / "training.json", "{\"config_hash\": \"aaaa\", ");
  EXPECT_DOUBLE_EQ(TrainLedger(project_, "aaaa").spent_s(), 0.0);
}

}  // namespace
}  // namespace skyquilt::coordinator
