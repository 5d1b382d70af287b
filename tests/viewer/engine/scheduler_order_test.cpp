// In which order the scheduler works.
#include <gtest/gtest.h>

#include "tests/viewer/engine/fake_engine.h"

namespace skyquilt::viewer {
namespace {

using Log = std::vector<std::string>;

class SchedulerOrder : public ::testing::Test, protected FakeEngine {};

TEST_F(SchedulerOrder, PicksThenSmallQuestionsThenFirstPassesThenTheRestInTurn) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  scheduler.Step();  // its first pass
  scheduler.Handle(1, Volume(5));
  scheduler.Handle(2, FakeEngine::View(1, 2));
  scheduler.Handle(3, ProfileRequest{.id = 6});
  scheduler.Handle(4, PickRequest{.id = 7});
  renderer.log.clear();
  for (int i = 0; i < 5; ++i) scheduler.Step();
  EXPECT_EQ(renderer.log, (Log{"pick", "profile", "profile", "profile", "view2"}));
  renderer.log.clear();
  for (int i = 0; i < 9; ++i) {
    scheduler.Step();
    Acknowledge(1);
    Acknowledge(2);
  }
  // Views of two clients and a volume: a third each.
  EXPECT_EQ(renderer.Count("view1"), 3);
  EXPECT_EQ(renderer.Count("view2"), 3);
  EXPECT_EQ(renderer.Count("volume"), 3);
}

TEST_F(SchedulerOrder, ANewViewOverTakesTheOldOneAtTheNextBatch) {
  scheduler.Handle(1, FakeEngine::View(1, 10));
  for (int i = 0; i < 8; ++i) scheduler.Step();
  renderer.log.clear();
  scheduler.Handle(1, FakeEngine::View(2, 20));
  Finish({1});
  EXPECT_EQ(renderer.Count("view10"), 0);
  EXPECT_EQ(frames[1].back(), (SentFrame{2, 7, 2}));
  for (const SentFrame& frame : frames[1]) EXPECT_TRUE(frame.seq == 2 || frame.pass < 2);
}

TEST_F(SchedulerOrder, StopAndCloseEndTheWork) {
  scheduler.Handle(1, FakeEngine::View(3, 10));
  scheduler.Handle(2, FakeEngine::View(1, 20));
  scheduler.Handle(1, StopView{2});  // of an older view
  scheduler.Step();
  EXPECT_EQ(renderer.Count("view10"), 1);
  scheduler.Handle(1, StopView{3});
  scheduler.Close(2);
  renderer.log.clear();
  EXPECT_FALSE(scheduler.Step());
  EXPECT_TRUE(renderer.log.empty());
}

TEST_F(SchedulerOrder, FourClientsGetTheirFirstFramesBeforeAnyIsRefined) {
  renderer.batch = 64;  // four batches per first pass
  for (ClientId client = 1; client <= 4; ++client) scheduler.Handle(client, FakeEngine::View(1, static_cast<int>(client)));
  for (int i = 0; i < 16; ++i) scheduler.Step();
  for (ClientId client = 1; client <= 4; ++client) {
    EXPECT_EQ(renderer.Count("view" + std::to_string(client)), 4);
    EXPECT_EQ(frames[client], std::vector<SentFrame>(1, SentFrame{1, 7, 0}));
  }
  // In turn: after any number of batches nobody is more than one ahead.
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(std::count(renderer.log.begin(), renderer.log.begin() + 4, "view" + std::to_string(i + 1)), 1);
  }
}

TEST_F(SchedulerOrder, AskingMoreOftenGivesNoMoreTurns) {
  query_steps = 50;
  for (uint32_t id = 0; id < 5; ++id) scheduler.Handle(1, Volume(id));
  scheduler.Handle(2, FakeEngine::View(1, 2));
  for (int i = 0; i < 13; ++i) {
    scheduler.Step();
    Acknowledge(2);
  }
  EXPECT_EQ(renderer.Count("volume"), 6);
  EXPECT_EQ(renderer.Count("view2"), 7);
}

TEST_F(SchedulerOrder, NothingWaitsForEver) {
  scheduler.Handle(1, FakeEngine::View(1, 1));
  scheduler.Handle(2, Volume(1));
  uint32_t id = 0, seq = 0;
  for (int i = 0; i < 400; ++i) {
    // A client that asks without pause, and one whose camera never rests.
    scheduler.Handle(3, PickRequest{.id = ++id});
    scheduler.Handle(4, FakeEngine::View(++seq, 1000 + i));
    scheduler.Step();
    Acknowledge(1);
    Acknowledge(4);
  }
  EXPECT_EQ(frames[1].back(), (SentFrame{1, 7, 2}));
  EXPECT_TRUE(Told(2, "reply of volume"));
}

TEST_F(SchedulerOrder, BatchesAreNoLargerThanTheRendererSays) {
  renderer.batch = 100;
  scheduler.Handle(1, FakeEngine::View(1, 1));
  Finish({1});
  EXPECT_EQ(*std::max_element(renderer.sizes.begin(), renderer.sizes.end()), 100U);
  size_t rays = 0;
  for (const size_t size : renderer.sizes) rays += size;
  EXPECT_EQ(rays, 256U + 1024U + 4096U);
}

}  // namespace
}  // namespace skyquilt::viewer
