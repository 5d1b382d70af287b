#include "prepare/video/frame_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/random.h"

namespace skyquilt::prepare::video {
namespace {

constexpr int kFrameWidth = 192, kFrameHeight = 144;

// Smooth ground with detail everywhere, seen from above.
double GroundAt(double x, double y) {
  double value = 0.0;
  static const std::vector<std::array<double, 4>> waves = [] {
    base::Random random(7);
    std::vector<std::array<double, 4>> made;
    for (int i = 0; i < 32; ++i) {
      const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi), length_px = random.Uniform(8.0, 60.0), phase = random.Uniform(0.0, 6.28);
      made.push_back({std::cos(angle) * 6.28 / length_px, std::sin(angle) * 6.28 / length_px, phase, random.Uniform(0.3, 1.0)});
    }
    return made;
  }();
  for (const auto& [kx, ky, phase, strength] : waves) value += strength * std::sin(kx * x + ky * y + phase);
  return value;
}

// What a camera sees of it that was moved by the shift, pixels from the middle.
image::Image8 SeenWith(const FrameShift& shift) {
  const FrameShift back = shift.Inverse();
  image::Image8 frame(kFrameWidth, kFrameHeight, 1);
  for (int y = 0; y < kFrameHeight; ++y) {
    for (int x = 0; x < kFrameWidth; ++x) {
      const double u = (x - 0.5 * (kFrameWidth - 1)) / kFrameWidth, v = (y - 0.5 * (kFrameHeight - 1)) / kFrameWidth;
      const double ground_x = kFrameWidth * (back.a * u - back.b * v + back.right), ground_y = kFrameWidth * (back.b * u + back.a * v + back.down);
      *frame.At(x, y) = static_cast<uint8_t>(std::clamp(128.0 + 19.0 * GroundAt(ground_x, ground_y), 0.0, 255.0));
    }
  }
  return frame;
}

void ExpectNear(const FrameShift& found, const FrameShift& shift) {
  EXPECT_NEAR(found.a, shift.a, 0.01);
  EXPECT_NEAR(found.b, shift.b, 0.01);
  EXPECT_NEAR(found.right, shift.right, 0.01);
  EXPECT_NEAR(found.down, shift.down, 0.01);
}

TEST(FrameTracker, FindsShiftsTurnsAndScales) {
  for (const FrameShift& shift :
       {FrameShift{.right = 0.2, .down = -0.05}, FrameShift{.down = 0.25}, FrameShift{.a = std::cos(0.06), .b = std::sin(0.06)},
        FrameShift{.a = 1.05, .right = 0.03}, FrameShift{.a = std::cos(-0.04), .b = std::sin(-0.04), .right = -0.1}}) {
    FrameTracker tracker;
    EXPECT_FALSE(tracker.Track(SeenWith({})));
    const std::optional<TrackedShift> tracked = tracker.Track(SeenWith(shift));
    ASSERT_TRUE(tracked) << shift.right << " " << shift.down;
    ExpectNear(tracked->shift, shift);
  }
}

TEST(FrameTracker, FollowsATurnThatGoesOn) {
  FrameTracker tracker;
  FrameShift sum;
  const FrameShift step{.a = std::cos(0.05), .b = std::sin(0.05), .right = 0.04};
  tracker.Track(SeenWith({}));
  for (int i = 0; i < 10; ++i) {
    sum = sum.Then(step);
    const std::optional<TrackedShift> tracked = tracker.Track(SeenWith(sum));
    ASSERT_TRUE(tracked) << i;
    ExpectNear(tracked->shift, step);
  }
}

TEST(FrameTracker, KnowsNoShiftBetweenOtherPictures) {
  FrameTracker tracker;
  tracker.Track(SeenWith({}));
  EXPECT_FALSE(tracker.Track(SeenWith({.right = 40.0, .down = 17.0})));
  EXPECT_TRUE(tracker.HasCorners());
  EXPECT_FALSE(tracker.Track(image::Image8(kFrameWidth, kFrameHeight, 1, 90)));
  EXPECT_FALSE(tracker.HasCorners()) << "water";
  EXPECT_FALSE(tracker.Track(image::Image8(8, 5, 1, 90))) << "another size";
}

TEST(FrameShift, TheInverseUndoesIt) {
  const FrameShift shift{.a = 0.9, .b = 0.4, .right = 0.3, .down = -0.2}, nothing = shift.Then(shift.Inverse());
  EXPECT_NEAR(nothing.a, 1.0, 1e-12);
  EXPECT_NEAR(nothing.b, 0.0, 1e-12);
  EXPECT_NEAR(nothing.right, 0.0, 1e-12);
  EXPECT_NEAR(nothing.down, 0.0, 1e-12);
}

TEST(NewShare, IsTheShareThatAShiftUncovers) {
  EXPECT_DOUBLE_EQ(NewShare({}, 0.75), 0.0);
  EXPECT_DOUBLE_EQ(NewShare({.right = 0.25}, 0.75), 0.25);
  EXPECT_DOUBLE_EQ(NewShare({.down = 0.25 * 0.75}, 0.75), 0.25);
  EXPECT_GT(NewShare({.a = 0.0, .b = 1.0}, 0.75), 0.3) << "a quarter turn";
  EXPECT_GT(NewShare({.right = 3.0}, 0.75), 2.9);
}

TEST(Sharpness, FallsWithBlur) {
  const image::Image8 sharp = SeenWith({});
  const image::Image8 blurred = image::Resize(image::Resize(sharp, kFrameWidth / 4, kFrameHeight / 4), kFrameWidth, kFrameHeight);
  EXPECT_GT(SharpnessOf(sharp), 2.0 * SharpnessOf(blurred));
  EXPECT_EQ(SharpnessOf(image::Image8(2, 2, 1, 5)), 0.0);
}

}  // namespace
}  // namespace skyquilt::prepare::video
