// Members of a team as threads of one process: they meet at a barrier instead of over a network.
#include <gtest/gtest.h>

#include <barrier>
#include <future>
#include <limits>
#include <optional>
#include <thread>
#include <vector>

#include "core/base/errors.h"
#include "tests/worker/small_survey.h"
#include "worker/trainer.h"

namespace skyquilt::worker {
namespace {

constexpr double kStay = std::numeric_limits<double>::infinity(), kGoHome = 0.0;

class TeamTest : public SmallSurvey {
 protected:
  struct Outcome {
    std::optional<TrainResult> leader;  // nothing when it was interrupted
    int shared_steps = 0;
    int helpers_ended = 0;
  };

  TrainJob JobWith(const std::string& name, int steps) const {
    TrainJob job = Job(name, steps);
    job.options.encoding = encoding_;
    return job;
  }

  Outcome TrainTogether(int members, double worth_it, const std::string& checkpoint, int steps, const Reporter& report = {}) {
    Outcome outcome;
    std::vector<std::string> said(static_cast<size_t>(members));
    std::barrier<> spoken(members), heard(members);
    std::promise<bool> summons;
    const std::shared_future<bool> summoned = summons.get_future().share();
    bool called = false;
    const auto job_of = [&](int number) {
      TrainJob job = JobWith(checkpoint, steps);
      job.options.checkpoint_every_s = 0.05;
      job.team = {.members = members, .number = number, .worth_it = worth_it, .summon = {}, .exchange = {}};
      job.team.exchange = [&, number](std::string own) {
        said[static_cast<size_t>(number)] = std::move(own);
        spoken.arrive_and_wait();
        std::vector<std::string> all = said;
        if (number == 0) ++outcome.shared_steps;
        heard.arrive_and_wait();
        return all;
      };
      job.team.summon = [&] {
        called = true;
        summons.set_value(true);
      };
      return job;
    };
    std::vector<std::thread> helpers;
    std::vector<int> ended(static_cast<size_t>(members), 0);
    for (int number = 1; number < members; ++number) {
      helpers.emplace_back([&, number] {
        if (!summoned.get()) return;
        base::ThreadPool one(1);
        try {
          TrainContext(job_of(number), Box(20.0, 0.0), one, {});
        } catch (const base::Interrupted&) {
        }
        ended[static_cast<size_t>(number)] = 1;
      });
    }
    base::ThreadPool two(2);
    try {
      outcome.leader = TrainContext(job_of(0), Box(20.0, 0.0), two, report);
    } catch (const base::Interrupted&) {
    }
    if (!called) summons.set_value(false);
    for (std::thread& helper : helpers) helper.join();
    for (const int one : ended) outcome.helpers_ended += one;
    return outcome;
  }

  std::string encoding_ = "hash";
};

TEST_F(TeamTest, SharedStepsHaveTheBitsOfOneAlone) {
  base::ThreadPool threads(2);
  ASSERT_TRUE(TrainContext(Job("alone.h5", 160), Box(20.0, 0.0), threads, {}).ok);
  for (const int members : {2, 3}) {
    const std::string name = std::to_string(members) + ".h5";
    const Outcome outcome = TrainTogether(members, kStay, name, 160);
    ASSERT_TRUE(outcome.leader && outcome.leader->ok);
    EXPECT_EQ(Bytes(name), Bytes("alone.h5")) << members << " members";
    EXPECT_EQ(outcome.shared_steps, 160 - 48 + 1) << "all steps after the summons, and the first word";
    EXPECT_EQ(outcome.helpers_ended, members - 1);
  }
}

TEST_F(TeamTest, SharedStepsHaveTheBitsOfOneAloneWithOtherEncodings) {
  base::ThreadPool threads(2);
  for (const char* encoding : {"planes", "frequency"}) {
    encoding_ = encoding;
    const std::string alone = encoding_ + "_alone.h5", together = encoding_ + "_together.h5";
    ASSERT_TRUE(TrainContext(JobWith(alone, 90), Box(20.0, 0.0), threads, {}).ok);
    const Outcome outcome = TrainTogether(2, kStay, together, 90);
    ASSERT_TRUE(outcome.leader && outcome.leader->ok);
    EXPECT_EQ(Bytes(together), Bytes(alone)) << encoding;
    EXPECT_GT(outcome.shared_steps, 30);
  }
}

TEST_F(TeamTest, MembersThatDoNotHelpGoHome) {
  base::ThreadPool threads(2);
  TrainContext(Job("alone.h5", 160), Box(20.0, 0.0), threads, {});
  const Outcome outcome = TrainTogether(2, kGoHome, "team.h5", 160);
  ASSERT_TRUE(outcome.leader && outcome.leader->ok);
  EXPECT_EQ(Bytes("team.h5"), Bytes("alone.h5"));
  EXPECT_LT(outcome.shared_steps, 60);
  EXPECT_EQ(outcome.helpers_ended, 1);
}

TEST_F(TeamTest, AnInterruptionStopsAllAndLosesNothing) {
  base::ThreadPool threads(2);
  TrainContext(Job("alone.h5", 160), Box(20.0, 0.0), threads, {});
  const Outcome stopped = TrainTogether(2, kStay, "team.h5", 4000, [](const TrainStatus& status) {
    if (status.step > 60) base::RequestCancel();
  });
  EXPECT_FALSE(stopped.leader);
  EXPECT_EQ(stopped.helpers_ended, 1) << "a member was left behind";
  base::ClearCancel();

  // The same for a training that then goes on to its end.
  base::RequestCancel();
  EXPECT_FALSE(TrainTogether(2, kStay, "again.h5", 160).leader);
  base::ClearCancel();
  EXPECT_TRUE(TrainTogether(2, kStay, "again.h5", 160).leader);
  EXPECT_EQ(Bytes("again.h5"), Bytes("alone.h5"));
}

}  // namespace
}  // namespace skyquilt::worker
