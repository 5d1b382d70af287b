// Which frames and texts the scheduler sends to whom.
#include <gtest/gtest.h>

#include "tests/viewer/engine/fake_engine.h"

namespace skyquilt::viewer {
namespace {

using Frames = std::vector<SentFrame>;

TEST(SchedulerFrames, AtMostTwoAreUnacknowledgedAndTheNewestWins) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.Finish({});
  EXPECT_EQ(engine.frames[1], (Frames{{1, 7, 0}, {1, 7, 1}}));
  engine.scheduler.Handle(1, FakeEngine::View(2, 2));
  engine.Finish({});
  EXPECT_EQ(engine.frames[1].size(), 2U);
  engine.scheduler.Handle(1, FrameAck{1, 5});  // never sent
  engine.Finish({});
  EXPECT_EQ(engine.frames[1].size(), 2U);
  engine.scheduler.Handle(1, FrameAck{1, 0});
  engine.Finish({});
  EXPECT_EQ(engine.frames[1], (Frames{{1, 7, 0}, {1, 7, 1}, {2, 7, 2}}));
}

TEST(SchedulerFrames, AClientThatNeverAcknowledgesHardlySlowsOthers) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1, 512));
  engine.scheduler.Handle(2, FakeEngine::View(1, 2, 512));
  for (int i = 0; i < 20000 && (engine.frames[2].empty() || engine.frames[2].back().pass < 2); ++i) {
    engine.scheduler.Step();
    engine.Acknowledge(2);
  }
  EXPECT_EQ(engine.frames[2], (Frames{{1, 7, 0}, {1, 7, 1}, {1, 7, 2}}));
  EXPECT_EQ(engine.frames[1], (Frames{{1, 7, 0}, {1, 7, 1}}));
  // Of its last pass, 1024 batches long, it got one turn in nine at most.
  EXPECT_LT(engine.renderer.Count("view1"), 64 + 256 + 1024 / 7);
}

TEST(SchedulerFrames, AClientWhoseQueueIsFullGetsTheNewestWhenItHasDrained) {
  FakeEngine engine;
  engine.queued[1] = FrameGate::kMaxQueuedBytes + 1;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.scheduler.Handle(2, FakeEngine::View(1, 2));
  engine.Finish({2});
  EXPECT_TRUE(engine.frames[1].empty());
  EXPECT_EQ(engine.frames[2].size(), 3U);
  engine.queued[1] = 0;
  engine.Finish({});
  EXPECT_EQ(engine.frames[1], (Frames{{1, 7, 2}}));
}

TEST(SchedulerFrames, AViewThatReturnsIsSentAtOnce) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.Finish({1});
  engine.renderer.log.clear();
  engine.scheduler.Handle(1, FakeEngine::View(2, 1));
  engine.scheduler.Handle(2, FakeEngine::View(9, 1));
  engine.Finish({1, 2});
  EXPECT_TRUE(engine.renderer.log.empty());
  EXPECT_EQ(engine.frames[1].back(), (SentFrame{2, 7, 2}));
  EXPECT_EQ(engine.frames[2], (Frames{{9, 7, 2}}));
  // Any difference is another view.
  ViewRequest other = FakeEngine::View(3, 1);
  other.fovy_deg += 1e-9;
  engine.scheduler.Handle(1, other);
  engine.Finish({1});
  EXPECT_FALSE(engine.renderer.log.empty());
}

TEST(SchedulerFrames, TwoClientsWithOneViewShareItsPasses) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.scheduler.Handle(2, FakeEngine::View(1, 1));
  engine.Finish({1, 2});
  EXPECT_EQ(engine.frames[1].back().pass, 2);
  EXPECT_EQ(engine.frames[2].back().pass, 2);
  EXPECT_LT(engine.renderer.log.size(), 2U * (1 + 4 + 16));
}

TEST(SchedulerFrames, ANewSceneDropsWorkAndCacheAndTellsAll) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.Finish({1});
  engine.scheduler.Handle(2, FakeEngine::View(1, 2));
  engine.scheduler.Handle(3, ProfileRequest{.id = 44});
  engine.scheduler.SetState(Ready(8), true);
  engine.renderer.log.clear();
  EXPECT_FALSE(engine.scheduler.Step());
  EXPECT_TRUE(engine.renderer.log.empty());
  for (ClientId client = 1; client <= 4; ++client) EXPECT_TRUE(engine.Told(client, "\"engine\""));
  EXPECT_TRUE(engine.Told(3, "44"));
  engine.scheduler.Handle(1, FakeEngine::View(2, 1));
  engine.Finish({1});
  EXPECT_FALSE(engine.renderer.log.empty());
  EXPECT_EQ(engine.frames[1].back(), (SentFrame{2, 8, 2}));
}

TEST(SchedulerFrames, NewFilesOfTheSameSceneKeepTheWork) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.scheduler.Step();
  engine.scheduler.SetState(Ready(8), false);
  engine.Finish({1});
  EXPECT_EQ(engine.frames[1], (Frames{{1, 7, 0}, {1, 8, 1}, {1, 8, 2}}));
  engine.scheduler.SetState(Ready(9), false);
  engine.scheduler.Handle(1, FakeEngine::View(2, 1));
  engine.Finish({1});
  EXPECT_EQ(engine.frames[1].back(), (SentFrame{2, 9, 2}));
}

TEST(SchedulerFrames, ErrorsOfOneClientsWorkAreToldToIt) {
  FakeEngine engine;
  engine.scheduler.Handle(2, FakeEngine::View(1, 2));
  engine.scheduler.Step();
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.renderer.on_render = [] { throw base::UsageError("too little memory"); };
  engine.scheduler.Step();
  engine.renderer.on_render = {};
  EXPECT_TRUE(engine.Told(1, "too little memory"));
  engine.Finish({2});
  EXPECT_EQ(engine.renderer.Count("view1"), 0);
  EXPECT_EQ(engine.frames[2].back().pass, 2);
  EXPECT_FALSE(engine.Told(2, "memory"));

  engine.scheduler.Handle(1, FakeEngine::View(2, 3));
  engine.renderer.on_render = [] { throw std::logic_error("secret of the program"); };
  engine.scheduler.Step();
  EXPECT_TRUE(engine.Told(1, "error"));
  EXPECT_FALSE(engine.Told(1, "secret"));

  engine.scheduler.Handle(1, FakeEngine::View(3, 3));
  engine.renderer.on_render = [] { throw base::Interrupted(); };
  EXPECT_THROW(engine.scheduler.Step(), base::Interrupted);
}

TEST(SchedulerFrames, QuestionsAreAnsweredCancelledAndLimited) {
  FakeEngine engine;
  engine.query_steps = 100;
  engine.scheduler.Handle(1, Volume(1));
  engine.scheduler.Handle(2, Volume(2));
  for (int i = 0; i < 20; ++i) engine.scheduler.Step();
  EXPECT_TRUE(engine.Told(1, "progress"));
  EXPECT_LE(engine.texts[1].size(), 6U);  // not after each step
  engine.scheduler.Handle(2, CancelRequest{2});
  engine.Finish({});
  EXPECT_TRUE(engine.Told(1, "reply of volume"));
  EXPECT_FALSE(engine.Told(2, "reply of volume"));

  engine.query_steps = -1;
  engine.scheduler.Handle(3, ProfileRequest{.id = 77});
  engine.Finish({});
  EXPECT_TRUE(engine.Told(3, "cannot be answered"));
  EXPECT_TRUE(engine.Told(3, "77"));

  engine.query_steps = 1;
  for (uint32_t id = 0; id < 2 * Scheduler::kMaxQuestions; ++id) engine.scheduler.Handle(4, ProfileRequest{.id = id});
  EXPECT_EQ(engine.texts[4].size(), Scheduler::kMaxQuestions);
  EXPECT_TRUE(engine.Told(4, "too many"));
}

TEST(SchedulerFrames, ViewsThatCannotBeShownAreRefused) {
  FakeEngine engine;
  ViewRequest view = FakeEngine::View(1, 1);
  view.project = Which::kBefore;
  engine.scheduler.Handle(1, view);
  view.seq = 2;
  engine.scheduler.Handle(1, view);
  EXPECT_EQ(engine.texts[1].size(), 1U);  // said once
  view = FakeEngine::View(2, 1);          // seq of the view before
  engine.scheduler.Handle(1, view);
  EXPECT_EQ(engine.texts[1].size(), 2U);
  view.seq = 3;
  view.photo = 12;
  engine.scheduler.Handle(1, view);
  EXPECT_TRUE(engine.Told(1, "no such photo"));
  EXPECT_FALSE(engine.scheduler.Step());
  engine.scheduler.Handle(99, FakeEngine::View(1, 1));  // an unknown client
  EXPECT_FALSE(engine.scheduler.Step());
}

}  // namespace
}  // namespace skyquilt::viewer
