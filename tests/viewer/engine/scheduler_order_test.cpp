// In which order the scheduler works.
#include <gtest/gtest.h>

#include "tests/viewer/engine/fake_engine.h"

namespace skyquilt::viewer {
namespace {

using Log = std::vector<std::string>;

TEST(SchedulerOrder, PicksThenSmallQuestionsThenFirstPassesThenTheRestInTurn) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.scheduler.Step();  // its first pass
  engine.scheduler.Handle(1, Volume(5));
  engine.scheduler.Handle(2, FakeEngine::View(1, 2));
  engine.scheduler.Handle(3, ProfileRequest{.id = 6});
  engine.scheduler.Handle(4, PickRequest{.id = 7});
  engine.renderer.log.clear();
  for (int i = 0; i < 5; ++i) engine.scheduler.Step();
  EXPECT_EQ(engine.renderer.log, (Log{"pick", "profile", "profile", "profile", "view2"}));
  engine.renderer.log.clear();
  for (int i = 0; i < 9; ++i) {
    engine.scheduler.Step();
    engine.Acknowledge(1);
    engine.Acknowledge(2);
  }
  // Views of two clients and a volume: a third each.
  EXPECT_EQ(engine.renderer.Count("view1"), 3);
  EXPECT_EQ(engine.renderer.Count("view2"), 3);
  EXPECT_EQ(engine.renderer.Count("volume"), 3);
}

TEST(SchedulerOrder, ANewViewOverTakesTheOldOneAtTheNextBatch) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 10));
  for (int i = 0; i < 8; ++i) engine.scheduler.Step();
  engine.renderer.log.clear();
  engine.scheduler.Handle(1, FakeEngine::View(2, 20));
  engine.Finish({1});
  EXPECT_EQ(engine.renderer.Count("view10"), 0);
  EXPECT_EQ(engine.frames[1].back(), (SentFrame{2, 7, 2}));
  for (const SentFrame& frame : engine.frames[1]) EXPECT_TRUE(frame.seq == 2 || frame.pass < 2);
}

TEST(SchedulerOrder, StopAndCloseEndTheWork) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(3, 10));
  engine.scheduler.Handle(2, FakeEngine::View(1, 20));
  engine.scheduler.Handle(1, StopView{2});  // of an older view
  engine.scheduler.Step();
  EXPECT_EQ(engine.renderer.Count("view10"), 1);
  engine.scheduler.Handle(1, StopView{3});
  engine.scheduler.Close(2);
  engine.renderer.log.clear();
  EXPECT_FALSE(engine.scheduler.Step());
  EXPECT_TRUE(engine.renderer.log.empty());
}

TEST(SchedulerOrder, FourClientsGetTheirFirstFramesBeforeAnyIsRefined) {
  FakeEngine engine;
  engine.renderer.batch = 64;  // four batches per first pass
  for (ClientId client = 1; client <= 4; ++client) engine.scheduler.Handle(client, FakeEngine::View(1, static_cast<int>(client)));
  for (int i = 0; i < 16; ++i) engine.scheduler.Step();
  for (ClientId client = 1; client <= 4; ++client) {
    EXPECT_EQ(engine.renderer.Count("view" + std::to_string(client)), 4);
    EXPECT_EQ(engine.frames[client], std::vector<SentFrame>(1, SentFrame{1, 7, 0}));
  }
  // In turn: after any number of batches nobody is more than one ahead.
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(std::count(engine.renderer.log.begin(), engine.renderer.log.begin() + 4, "view" + std::to_string(i + 1)), 1);
  }
}

TEST(SchedulerOrder, AskingMoreOftenGivesNoMoreTurns) {
  FakeEngine engine;
  engine.query_steps = 50;
  for (uint32_t id = 0; id < 5; ++id) engine.scheduler.Handle(1, Volume(id));
  engine.scheduler.Handle(2, FakeEngine::View(1, 2));
  for (int i = 0; i < 13; ++i) {
    engine.scheduler.Step();
    engine.Acknowledge(2);
  }
  EXPECT_EQ(engine.renderer.Count("volume"), 6);
  EXPECT_EQ(engine.renderer.Count("view2"), 7);
}

TEST(SchedulerOrder, NothingWaitsForEver) {
  FakeEngine engine;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.scheduler.Handle(2, Volume(1));
  uint32_t id = 0, seq = 0;
  for (int i = 0; i < 400; ++i) {
    // A client that asks without pause, and one whose camera never rests.
    engine.scheduler.Handle(3, PickRequest{.id = ++id});
    engine.scheduler.Handle(4, FakeEngine::View(++seq, 1000 + i));
    engine.scheduler.Step();
    engine.Acknowledge(1);
    engine.Acknowledge(4);
  }
  EXPECT_EQ(engine.frames[1].back(), (SentFrame{1, 7, 2}));
  EXPECT_TRUE(engine.Told(2, "reply of volume"));
}

TEST(SchedulerOrder, BatchesAreNoLargerThanTheRendererSays) {
  FakeEngine engine;
  engine.renderer.batch = 100;
  engine.scheduler.Handle(1, FakeEngine::View(1, 1));
  engine.Finish({1});
  EXPECT_EQ(*std::max_element(engine.renderer.sizes.begin(), engine.renderer.sizes.end()), 100U);
  size_t rays = 0;
  for (const size_t size : engine.renderer.sizes) rays += size;
  EXPECT_EQ(rays, 256U + 1024U + 4096U);
}

}  // namespace
}  // namespace skyquilt::viewer
