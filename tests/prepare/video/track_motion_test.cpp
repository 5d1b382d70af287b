#include "prepare/video/track_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace skyquilt::prepare::video {
namespace {

constexpr double kDegreeOfMetre = 1.0 / 111'320.0;

// At the equator, so that a degree is as long in both directions.
TrackPoint At(double east_m, double north_m, double height_m, double yaw_deg, double pitch_deg) {
  TrackPoint point;
  SetPosition(1e-9 + north_m * kDegreeOfMetre, 8.0 + east_m * kDegreeOfMetre, point);
  point.relative_altitude_m = height_m;
  point.gimbal_yaw_deg = yaw_deg;
  point.gimbal_pitch_deg = pitch_deg;
  point.focal_35mm = 36.0;  // as long as the frame is wide
  return point;
}

FrameShift ShiftOf(const TrackPoint& from, const TrackPoint& to) {
  const std::vector<TrackPoint> states = {from, to};
  const auto shifts = ShiftsByTrack(states);
  EXPECT_TRUE(shifts);
  return shifts ? shifts->back() : FrameShift();
}

TEST(ShiftsByTrack, TheGroundMovesAgainstTheDrone) {
  const FrameShift ahead = ShiftOf(At(0, 0, 100, 0, -90), At(0, 25, 100, 0, -90));
  EXPECT_NEAR(ahead.down, 0.25, 1e-6) << "the ground ahead comes nearer to the lower edge";
  EXPECT_NEAR(ahead.right, 0.0, 1e-6);
  const FrameShift east = ShiftOf(At(0, 0, 100, 90, -90), At(25, 0, 100, 90, -90));
  EXPECT_NEAR(east.down, 0.25, 1e-6) << "ahead of a drone that looks east";
  const FrameShift aside = ShiftOf(At(0, 0, 50, 0, -90), At(10, 0, 50, 0, -90));
  EXPECT_NEAR(aside.right, -0.2, 1e-6);
}

TEST(ShiftsByTrack, TurnsTurnThePicture) {
  const FrameShift turn = ShiftOf(At(0, 0, 100, 0, -90), At(0, 0, 100, 10, -90));
  EXPECT_NEAR(std::atan2(turn.b, turn.a), -10.0 * M_PI / 180.0, 1e-9) << "to the right: the picture to the left";
  const FrameShift over_north = ShiftOf(At(0, 0, 100, 355, -90), At(0, 0, 100, -4, -90));
  EXPECT_NEAR(std::atan2(over_north.b, over_north.a), -1.0 * M_PI / 180.0, 1e-9);
  EXPECT_NEAR(ShiftOf(At(0, 0, 100, 0, -90), At(0, 0, 50, 0, -90)).a, 2.0, 1e-9) << "half as high, twice as large";
}

TEST(ShiftsByTrack, NeedPlaceHeightAndACameraThatLooksDown) {
  const TrackPoint good = At(0, 0, 100, 0, -90);
  TrackPoint no_height = good, low = good, level = good, no_place = good;
  no_height.relative_altitude_m.reset();
  low.relative_altitude_m = 1.0;
  level.gimbal_pitch_deg = -20.0;
  no_place.latitude_deg.reset();
  for (const TrackPoint& bad : {no_height, low, level, no_place}) {
    const std::vector<TrackPoint> states = {good, bad};
    EXPECT_FALSE(ShiftsByTrack(states));
  }
}

}  // namespace
}  // namespace skyquilt::prepare::video
