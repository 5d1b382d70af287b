#include "coordinator/stages/timed_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "coordinator/planning/run_ledger.h"
#include "coordinator/stages/stage.h"
#include "tests/support/connect_alone.h"
#include "tests/support/project_fixture.h"

namespace skyquilt::coordinator {
namespace {

class TimedRuns : public ProjectFixture {
 protected:
  // As a run left it that was killed in the training.
  void LeaveTraining() {
    RunLedger ledger(
        project_, [this] { return now_s_; }, 0.0);
    ledger.Start();
    ledger.SetGivenUp("prepare", {{"features", "prepare", "fewer features"}});
    ledger.Decide("prepare", 10.0, {{"prepare.max_features", "2048"}});
    ledger.Begin("prepare");
    now_s_ += 12.0;
    ledger.End("prepare");
    ledger.Decide("train", 40.0, {{"run.time_budget_s", "38.500"}});
    ledger.Begin("train");
    now_s_ += 8.0;
  }
  Pipeline Begun(double within_s) const {
    Pipeline pipeline{.comm = *comm_, .project = project_, .settings = {}};
    pipeline.settings.run.within_s = within_s;
    return pipeline;
  }

  const std::unique_ptr<comm::Communicator> comm_ = comm::ConnectAlone();
  double now_s_ = 0.0;
};

TEST_F(TimedRuns, AResumedRunHasTheOptionsOfTheStagesThatHaveBegun) {
  LeaveTraining();
  Pipeline pipeline = Begun(100.0);
  pipeline.level_settings = pipeline.settings;
  const TimedRun timed(pipeline, [this] { return now_s_; });
  for (const Settings* settings : {&pipeline.settings, &*pipeline.level_settings}) {
    EXPECT_EQ(settings->prepare.max_features, 2048);
    EXPECT_EQ(settings->run.time_budget_s, 38.5);
    EXPECT_TRUE(settings->run.budget_has_everything);
  }
  EXPECT_EQ(timed.UsedSeconds(), 20.0);
  const evaluate::metrics::RunTimes times = timed.Times();
  EXPECT_EQ(times.within_s, 100.0);
  ASSERT_EQ(times.stages.size(), 2U);
  EXPECT_EQ(times.stages.front().took_s, 12.0);
  EXPECT_TRUE(std::isnan(times.stages.back().took_s));
  EXPECT_EQ(times.given_up, std::vector<std::string>{"fewer features"});
}

TEST_F(TimedRuns, ARestartForgetsThem) {
  LeaveTraining();
  Pipeline pipeline = Begun(100.0);
  pipeline.restart = true;
  const TimedRun timed(pipeline, [this] { return now_s_; });
  EXPECT_EQ(pipeline.settings.prepare.max_features, Settings().prepare.max_features);
  EXPECT_EQ(timed.UsedSeconds(), 0.0);
}

TEST_F(TimedRuns, AGivenTrainingTimeKeepsItsMeaning) {
  Pipeline pipeline = Begun(100.0);
  pipeline.settings.run.time_budget_s = 30.0;
  const TimedRun timed(pipeline, [this] { return now_s_; });
  EXPECT_FALSE(pipeline.settings.run.budget_has_everything);
  EXPECT_EQ(pipeline.settings.run.time_budget_s, 30.0);
}

TEST_F(TimedRuns, WithoutATotalThereIsNone) {
  Pipeline pipeline = Begun(0.0);
  UseTotalTime(pipeline);
  EXPECT_EQ(pipeline.timed, nullptr);
}

// A reduction is decided when its stage begins: options of stages before it have their results by then.
TEST(ReductionsOfStages, ChangeNoOptionOfAnEarlierStage) {
  const WorkSize size{.photos = 200, .held_out = 25, .photo_pixels = 12e6, .photo_width = 4000, .surface_pixels = 2e8, .photo_gsd_m = 0.0125};
  Settings settings;
  settings.tour.auto_stops = 3;
  const std::vector<Reduction> list = ReductionsOf(settings, size);
  ASSERT_FALSE(list.empty());
  for (const Reduction& reduction : list) {
    Settings less = settings;
    Apply(reduction, &less);
    for (const Stage& stage : Stages()) {
      if (stage.name == reduction.stage) break;
      EXPECT_EQ(StageOptions(stage, less), StageOptions(stage, settings)) << reduction.text << ": " << stage.name;
    }
  }
}

TEST(PlansOfNewRuns, HaveAllStagesAndNoneThatIsNotMade) {
  const WorkSize size{.photos = 50, .held_out = 7, .photo_pixels = 2e6, .photo_width = 1600, .surface_pixels = 1e7};
  const Predictor predictor(size, Rates::Usual(2));
  Settings settings;
  const Room room{.memory_limit = 1e12, .disk = 1e15};
  const Plan plan = PlanOfNewRun(predictor, settings, 3600.0, room);
  EXPECT_TRUE(plan.feasible && plan.reductions.empty());
  for (const char* stage : {"prepare", "partition", "train", "merge", "products", "surface", "buildings", "evaluate"}) {
    EXPECT_NE(plan.Find(stage), nullptr) << stage;
  }
  EXPECT_EQ(plan.Find("tour"), nullptr);
  settings.train.steps = 500;
  EXPECT_NEAR(PlanOfNewRun(predictor, settings, 3600.0, room).training_s, predictor.Seconds("train", settings), 1e-9);
}

}  // namespace
}  // namespace skyquilt::coordinator
