#include "prepare/video/choose_frames.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <set>

namespace skyquilt::prepare::video {
namespace {

constexpr double kAspect = 0.75;

// A drone that flies on evenly: the picture moves by `step` of its height from frame to frame.
std::vector<Candidate> EvenFlight(int n, double step) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < n; ++i) candidates.push_back({.time_s = 0.2 * i, .sharpness = 100.0, .from_first = {.down = step * kAspect * i}});
  return candidates;
}

std::vector<size_t> Indices(const std::vector<ChosenFrame>& frames) {
  std::vector<size_t> indices;
  for (const ChosenFrame& frame : frames) indices.push_back(frame.candidate);
  return indices;
}

TEST(ChooseFrames, NeighboursOverlapAsAskedFor) {
  const std::vector<ChosenFrame> frames = ChooseFrames(EvenFlight(101, 0.05), kAspect, 0.75);
  ASSERT_GT(frames.size(), 15U);
  EXPECT_EQ(frames.front().reason, FrameReason::kFirst);
  for (size_t i = 1; i + 1 < frames.size(); ++i) {
    EXPECT_GE(frames[i].overlap, 0.70 - 1e-9);
    EXPECT_LE(frames[i].overlap, 0.80 + 1e-9);
    EXPECT_EQ(frames[i].reason, FrameReason::kOverlap);
  }
}

TEST(ChooseFrames, TheSharpestOfThoseThatWouldDoIsTaken) {
  std::vector<Candidate> candidates = EvenFlight(40, 0.02);
  candidates[14].sharpness = 120.0;
  const std::vector<ChosenFrame> frames = ChooseFrames(candidates, kAspect, 0.75);
  EXPECT_EQ(frames[1].candidate, 14U);
  EXPECT_EQ(frames[1].n_compared, 6U) << "20 to 30 % are new in frames 10 to 15";
}

TEST(ChooseFrames, ABlurredStretchIsAvoided) {
  std::vector<Candidate> candidates = EvenFlight(40, 0.02);
  for (size_t i = 9; i < 20; ++i) candidates[i].sharpness = 10.0;
  const std::vector<ChosenFrame> frames = ChooseFrames(candidates, kAspect, 0.75);
  EXPECT_LT(frames[1].candidate, 9U);
  EXPECT_EQ(frames[1].reason, FrameReason::kSharper);
}

TEST(ChooseFrames, ADroneThatHoversGivesOneFrame) {
  std::vector<Candidate> candidates = EvenFlight(500, 0.0);
  for (size_t i = 0; i < candidates.size(); ++i) candidates[i].from_first.right = 0.02 * std::sin(static_cast<double>(i));
  EXPECT_EQ(ChooseFrames(candidates, kAspect, 0.75).size(), 1U);
}

TEST(ChooseFrames, FastFlightsTakeTheNextFrameThereIs) {
  const std::vector<ChosenFrame> frames = ChooseFrames(EvenFlight(6, 0.6), kAspect, 0.75);
  EXPECT_EQ(Indices(frames), (std::vector<size_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(frames[3].reason, FrameReason::kFast);
  EXPECT_NEAR(frames[3].overlap, 0.4, 1e-9);
}

TEST(ChooseFrames, BeginAnewAfterAJump) {
  std::vector<Candidate> candidates = EvenFlight(20, 0.05);
  for (size_t i = 12; i < 20; ++i) {
    candidates[i].section = 1;
    candidates[i].from_first = {.down = 0.05 * kAspect * static_cast<double>(i - 12)};
  }
  const std::vector<ChosenFrame> frames = ChooseFrames(candidates, kAspect, 0.75);
  const auto jump = std::find_if(frames.begin(), frames.end(), [](const ChosenFrame& frame) { return frame.reason == FrameReason::kJump; });
  ASSERT_NE(jump, frames.end());
  EXPECT_GE(jump->candidate, 12U);
  EXPECT_LE(jump->candidate, 13U);
}

TEST(ChooseFrames, OfNothingIsNothing) {
  EXPECT_TRUE(ChooseFrames({}, kAspect, 0.75).empty());
}

std::vector<Candidate> AnyFlight() {
  std::vector<Candidate> candidates;
  FrameShift shift;
  int section = 0;
  double time_s = 0.0;
  const int n = *rc::gen::inRange(1, 120);
  for (int i = 0; i < n; ++i) {
    if (*rc::gen::inRange(0, 30) == 0) {
      ++section;
      shift = {};
    }
    const double turn = 0.01 * *rc::gen::inRange(-10, 10), right = 0.01 * *rc::gen::inRange(-20, 20), down = 0.01 * *rc::gen::inRange(-20, 20);
    shift = shift.Then({.a = std::cos(turn), .b = std::sin(turn), .right = right, .down = down});
    time_s += 0.01 * *rc::gen::inRange(1, 100);
    candidates.push_back({time_s, static_cast<double>(*rc::gen::inRange(0, 1000)), shift, section});
  }
  return candidates;
}

RC_GTEST_PROP(ChooseFrames, GoForwardAndReachEverySection, ()) {
  const std::vector<Candidate> candidates = AnyFlight();
  const double overlap = 0.01 * *rc::gen::inRange(0, 95);
  std::set<int> sections, reached;
  for (const Candidate& candidate : candidates) sections.insert(candidate.section);
  const std::vector<ChosenFrame> frames = ChooseFrames(candidates, kAspect, overlap);
  for (size_t i = 0; i < frames.size(); ++i) {
    RC_ASSERT(frames[i].candidate < candidates.size());
    if (i > 0) RC_ASSERT(frames[i].candidate > frames[i - 1].candidate);
    reached.insert(candidates[frames[i].candidate].section);
  }
  RC_ASSERT(reached == sections);
}

RC_GTEST_PROP(ChooseFrames, OfAllVideosKeepTheLimit, ()) {
  std::vector<VideoCandidates> videos;
  const int n_videos = *rc::gen::inRange(1, 4);
  for (int i = 0; i < n_videos; ++i) videos.push_back({AnyFlight(), kAspect});
  const int limit = *rc::gen::inRange(1, 40);
  const FrameChoice all = ChooseFramesOfAll(videos, 0.75, 0), choice = ChooseFramesOfAll(videos, 0.75, limit);
  const auto count = [](const FrameChoice& one) {
    size_t n = 0;
    for (const std::vector<ChosenFrame>& frames : one.frames) n += frames.size();
    return n;
  };
  RC_ASSERT(choice.frames.size() == videos.size());
  RC_ASSERT(count(choice) <= static_cast<size_t>(limit));
  RC_ASSERT(count(choice) > 0U);
  if (count(all) <= static_cast<size_t>(limit)) RC_ASSERT(count(choice) == count(all));
  if (choice.thinned) RC_ASSERT(count(choice) == static_cast<size_t>(limit));
}

}  // namespace
}  // namespace skyquilt::prepare::video
