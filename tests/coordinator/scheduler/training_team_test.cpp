#include "coordinator/scheduler/training_team.h"

#include <gtest/gtest.h>

#include <thread>

#include "coordinator/ranks/messages.h"
#include "coordinator/scheduler/coordinate.h"
#include "core/base/errors.h"
#include "fake_ranks.h"

namespace skyquilt::coordinator {
namespace {

FieldJob JobOf(const std::vector<int>& team) {
  FieldJob job;
  job.name = "context";
  job.team = team;
  return job;
}

TEST(TrainingTeam, EverybodyHearsEverybodyStepByStep) {
  const std::vector<int> team = {0, 3, 1};
  FakeNetwork network(4);
  std::vector<std::thread> threads;
  for (size_t number = 0; number < team.size(); ++number) {
    threads.emplace_back([&, number] {
      FakeRank rank(network, team[number]);
      const worker::Team own = MakeTeam(rank, JobOf(team));
      EXPECT_EQ(own.number, static_cast<int>(number));
      EXPECT_EQ(own.members, 3);
      for (int step = 0; step < 50; ++step) {
        const auto word = [&](size_t of) { return std::to_string(step) + " of " + std::to_string(of); };
        // Some are quicker than others.
        if (number == static_cast<size_t>(step % 3)) std::this_thread::sleep_for(std::chrono::microseconds(300));
        const std::vector<std::string> all = own.exchange(word(number));
        ASSERT_EQ(all.size(), 3U);
        for (size_t other = 0; other < 3; ++other) EXPECT_EQ(all[other], word(other));
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(TrainingTeam, PrefersOtherMachines) {
  const auto member = [](int rank, const std::string& host) { return CrewMember{.rank = rank, .host = host}; };
  const std::vector<CrewMember> crew = {member(1, "a"), member(2, "a"), member(3, "b"), member(4, "b"), member(5, "c")};
  EXPECT_EQ(ChooseTeam(crew, "a", 1), std::vector<int>());
  EXPECT_EQ(ChooseTeam(crew, "a", 0), (std::vector<int>{0, 3, 5})) << "one of every machine";
  EXPECT_EQ(ChooseTeam(crew, "a", 2), (std::vector<int>{0, 3}));
  EXPECT_EQ(ChooseTeam(crew, "a", 4).size(), 4U);
  EXPECT_EQ(ChooseTeam(crew, "a", 16).size(), 6U);
  EXPECT_EQ(ChooseTeam({member(1, "a"), member(2, "a")}, "a", 0), std::vector<int>()) << "ranks of one machine share its cores";
  EXPECT_EQ(ChooseTeam({}, "a", 5), std::vector<int>());
}

TEST(TrainingTeam, SummonsWithTheJob) {
  FakeNetwork network(3);
  FakeRank zero(network, 0), two(network, 2);
  MakeTeam(zero, JobOf({0, 2})).summon();
  const std::optional<comm::Message> message = two.TryReceive();
  ASSERT_TRUE(message && message->tag == kTagJob);
  EXPECT_EQ(JobFromText(message->bytes).team, (std::vector<int>{0, 2}));
}

TEST(TrainingTeam, AMemberThatIsSentBackLeaves) {
  FakeNetwork network(2);
  FakeRank zero(network, 0), one(network, 1);
  const worker::Team team = MakeTeam(one, JobOf({0, 1}));
  zero.Send(1, kTagDone, "");
  EXPECT_THROW(team.exchange("a"), base::Interrupted);
}

TEST(TrainingTeam, RankZeroHearsOfAMemberThatFailed) {
  FakeNetwork network(2);
  FakeRank zero(network, 0), one(network, 1);
  const worker::Team team = MakeTeam(zero, JobOf({0, 1}));
  FieldOutcome outcome;
  outcome.job = JobOf({0, 1});
  outcome.failure = Failure::kInput;
  outcome.reason = "/data/a.jpg: cannot be read";
  // One of an earlier try says nothing about this one.
  outcome.job.attempt = 1;
  one.Send(0, kTagOutcome, ToText(outcome));
  outcome.job.attempt = 0;
  one.Send(0, kTagOutcome, ToText(outcome));
  EXPECT_THROW(team.exchange("a"), base::InputError);
}

}  // namespace
}  // namespace skyquilt::coordinator
