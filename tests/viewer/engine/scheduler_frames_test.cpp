// Which frames and texts the scheduler sends to whom.
#include <gtest/gtest.h>

#include "tests/viewer/engine/fake_engine.h"

namespace skyquilt::viewer {
namespace {

using Frames = std::vector<SentFrame>;

class SchedulerFrames : public ::testing::Test, protected FakeEngine {};

TEST_F(SchedulerFrames, AtMostTwoAreUnacknowledgedAndTheNewestWins) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  Finish({});
  EXPECT_EQ(frames[1], (Frames{{1, 7, 0}, {1, 7, 1}}));
  scheduler.Handle(1, FakeEngine::View(2, 2));
  Finish({});
  EXPECT_EQ(frames[1].size(), 2U);
  scheduler.Handle(1, FrameAck{1, 5});  // never sent
  Finish({});
  EXPECT_EQ(frames[1].size(), 2U);
  scheduler.Handle(1, FrameAck{1, 0});
  Finish({});
  EXPECT_EQ(frames[1], (Frames{{1, 7, 0}, {1, 7, 1}, {2, 7, 2}}));
}

TEST_F(SchedulerFrames, AClientThatNeverAcknowledgesHardlySlowsOthers) {
  scheduler.Handle(1, FakeEngine::View(1, 1, 512));
  scheduler.Handle(2, FakeEngine::View(1, 2, 512));
  for (int i = 0; i < 20000 && (frames[2].empty() || frames[2].back().pass < 2); ++i) {
    scheduler.Step();
    Acknowledge(2);
  }
  EXPECT_EQ(frames[2], (Frames{{1, 7, 0}, {1, 7, 1}, {1, 7, 2}}));
  EXPECT_EQ(frames[1], (Frames{{1, 7, 0}, {1, 7, 1}}));
  // Of its last pass, 1024 batches long, it got one turn in nine at most.
  EXPECT_LT(renderer.Count("view1"), 64 + 256 + 1024 / 7);
}

TEST_F(SchedulerFrames, AClientWhoseQueueIsFullGetsTheNewestWhenItHasDrained) {
  queued[1] = FrameGate::kMaxQueuedBytes + 1;
  scheduler.Handle(1, FakeEngine::View(1, 1));
  scheduler.Handle(2, FakeEngine::View(1, 2));
  Finish({2});
  EXPECT_TRUE(frames[1].empty());
  EXPECT_EQ(frames[2].size(), 3U);
  queued[1] = 0;
  Finish({});
  EXPECT_EQ(frames[1], (Frames{{1, 7, 2}}));
}

TEST_F(SchedulerFrames, AViewThatReturnsIsSentAtOnce) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  Finish({1});
  renderer.log.clear();
  scheduler.Handle(1, FakeEngine::View(2, 1));
  scheduler.Handle(2, FakeEngine::View(9, 1));
  Finish({1, 2});
  EXPECT_TRUE(renderer.log.empty());
  EXPECT_EQ(frames[1].back(), (SentFrame{2, 7, 2}));
  EXPECT_EQ(frames[2], (Frames{{9, 7, 2}}));
  // Any difference is another view.
  ViewRequest other = FakeEngine::View(3, 1);
  other.fovy_deg += 1e-9;
  scheduler.Handle(1, other);
  Finish({1});
  EXPECT_FALSE(renderer.log.empty());
}

TEST_F(SchedulerFrames, TwoClientsWithOneViewShareItsPasses) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  scheduler.Handle(2, FakeEngine::View(1, 1));
  Finish({1, 2});
  EXPECT_EQ(frames[1].back().pass, 2);
  EXPECT_EQ(frames[2].back().pass, 2);
  EXPECT_LT(renderer.log.size(), 2U * (1 + 4 + 16));
}

TEST_F(SchedulerFrames, ANewSceneDropsWorkAndCacheAndTellsAll) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  Finish({1});
  scheduler.Handle(2, FakeEngine::View(1, 2));
  scheduler.Handle(3, ProfileRequest{.id = 44});
  scheduler.SetState(Ready(8), true);
  renderer.log.clear();
  EXPECT_FALSE(scheduler.Step());
  EXPECT_TRUE(renderer.log.empty());
  for (ClientId client = 1; client <= 4; ++client) EXPECT_TRUE(Told(client, "\"engine\""));
  EXPECT_TRUE(Told(3, "44"));
  scheduler.Handle(1, FakeEngine::View(2, 1));
  Finish({1});
  EXPECT_FALSE(renderer.log.empty());
  EXPECT_EQ(frames[1].back(), (SentFrame{2, 8, 2}));
}

TEST_F(SchedulerFrames, NewFilesOfTheSameSceneKeepTheWork) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  scheduler.Step();
  scheduler.SetState(Ready(8), false);
  Finish({1});
  EXPECT_EQ(frames[1], (Frames{{1, 7, 0}, {1, 8, 1}, {1, 8, 2}}));
  scheduler.SetState(Ready(9), false);
  scheduler.Handle(1, FakeEngine::View(2, 1));
  Finish({1});
  EXPECT_EQ(frames[1].back(), (SentFrame{2, 9, 2}));
}

TEST_F(SchedulerFrames, ErrorsOfOneClientsWorkAreToldToIt) {
  scheduler.Handle(2, FakeEngine::View(1, 2));
  scheduler.Step();
  scheduler.Handle(1, FakeEngine::View(1, 1));
  renderer.on_render = [] { throw base::UsageError("too little memory"); };
  scheduler.Step();
  renderer.on_render = {};
  EXPECT_TRUE(Told(1, "too little memory"));
  Finish({2});
  EXPECT_EQ(renderer.Count("view1"), 0);
  EXPECT_EQ(frames[2].back().pass, 2);
  EXPECT_FALSE(Told(2, "memory"));

  scheduler.Handle(1, FakeEngine::View(2, 3));
  renderer.on_render = [] { throw std::logic_error("secret of the program"); };
  scheduler.Step();
  EXPECT_TRUE(Told(1, "error"));
  EXPECT_FALSE(Told(1, "secret"));

  scheduler.Handle(1, FakeEngine::View(3, 3));
  renderer.on_render = [] { throw base::Interrupted(); };
  EXPECT_THROW(scheduler.Step(), base::Interrupted);
}

TEST_F(SchedulerFrames, QuestionsAreAnsweredCancelledAndLimited) {
  query_steps = 100;
  scheduler.Handle(1, Volume(1));
  scheduler.Handle(2, Volume(2));
  for (int i = 0; i < 20; ++i) scheduler.Step();
  EXPECT_TRUE(Told(1, "progress"));
  EXPECT_LE(texts[1].size(), 6U);  // not after each step
  scheduler.Handle(2, CancelRequest{2});
  Finish({});
  EXPECT_TRUE(Told(1, "reply of volume"));
  EXPECT_FALSE(Told(2, "reply of volume"));

  query_steps = -1;
  scheduler.Handle(3, ProfileRequest{.id = 77});
  Finish({});
  EXPECT_TRUE(Told(3, "cannot be answered"));
  EXPECT_TRUE(Told(3, "77"));

  query_steps = 1;
  for (uint32_t id = 0; id < 2 * Scheduler::kMaxQuestions; ++id) scheduler.Handle(4, ProfileRequest{.id = id});
  EXPECT_EQ(texts[4].size(), Scheduler::kMaxQuestions);
  EXPECT_TRUE(Told(4, "too many"));
}

TEST_F(SchedulerFrames, ViewsThatCannotBeShownAreRefused) {
  ViewRequest view = FakeEngine::View(1, 1);
  view.project = Which::kBefore;
  scheduler.Handle(1, view);
  view.seq = 2;
  scheduler.Handle(1, view);
  EXPECT_EQ(texts[1].size(), 1U);  // said once
  view = FakeEngine::View(2, 1);   // seq of the view before
  scheduler.Handle(1, view);
  EXPECT_EQ(texts[1].size(), 2U);
  view.seq = 3;
  view.photo = 12;
  scheduler.Handle(1, view);
  EXPECT_TRUE(Told(1, "no such photo"));
  EXPECT_FALSE(scheduler.Step());
  scheduler.Handle(99, FakeEngine::View(1, 1));  // an unknown client
  EXPECT_FALSE(scheduler.Step());
}

}  // namespace
}  // namespace skyquilt::viewer
