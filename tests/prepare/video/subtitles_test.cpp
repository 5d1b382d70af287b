#include "prepare/video/subtitles.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::video {
namespace {

FlightTrack Parsed(const std::string& text) {
  std::istringstream in(text);
  return ParseSubtitles(in, "flight.SRT");
}

// What the only block tells.
TrackPoint PointOf(const std::string& block) {
  const FlightTrack track = Parsed("1\n00:00:02,500 --> 00:00:03,500\n" + block + "\n\n");
  EXPECT_EQ(track.points.size(), 1U) << block;
  return track.points.empty() ? TrackPoint() : track.points.front();
}

void ExpectPlace(const TrackPoint& point, double latitude_deg, double longitude_deg) {
  ASSERT_TRUE(point.latitude_deg && point.longitude_deg);
  EXPECT_DOUBLE_EQ(*point.latitude_deg, latitude_deg);
  EXPECT_DOUBLE_EQ(*point.longitude_deg, longitude_deg);
}

TEST(Subtitles, ReadKeysInBrackets) {
  const TrackPoint point = PointOf(
      "<font size=\"28\">FrameCnt: 76, DiffTime: 33ms\n2024-03-20 12:59:17.852\n[iso: 400] [shutter: 1/320.0] [fnum: 1.7] [ev: 0] [ct: 5562] "
      "[color_md : default] [focal_len: 24.00] [dzoom_ratio: 1.00], [latitude: -33.868800] [longitude: 151.209300] [rel_alt: 6.500 abs_alt: -32.309] "
      "[gb_yaw: 33.5 gb_pitch: -60.0 gb_roll: 0.1] </font>");
  ExpectPlace(point, -33.8688, 151.2093);
  EXPECT_DOUBLE_EQ(point.time_s, 2.5);
  EXPECT_DOUBLE_EQ(point.relative_altitude_m.value(), 6.5);
  EXPECT_DOUBLE_EQ(point.altitude_m.value(), -32.309);
  EXPECT_DOUBLE_EQ(point.gimbal_yaw_deg.value(), 33.5);
  EXPECT_DOUBLE_EQ(point.gimbal_pitch_deg.value(), -60.0);
  EXPECT_DOUBLE_EQ(point.gimbal_roll_deg.value(), 0.1);
  EXPECT_DOUBLE_EQ(point.iso.value(), 400.0);
  EXPECT_DOUBLE_EQ(point.exposure_time_s.value(), 1.0 / 320.0);
  EXPECT_DOUBLE_EQ(point.f_number.value(), 1.7);
  EXPECT_DOUBLE_EQ(point.focal_35mm.value(), 24.0);
  EXPECT_NEAR(point.clock_s.value(), 1710939557.852, 1e-6);
}

TEST(Subtitles, ReadWholeNumbersOfOlderFirmwareAndItsSpelling) {
  const TrackPoint point = PointOf(
      "<font size=\"36\">SrtCnt : 1, DiffTime : 33ms\n2019-09-26 18:24:53,390,617\n[iso : 100] [shutter : 1/80] [fnum : 280] [ev : 0] "
      "[focal_len : 240] [latitude : 41.424724] [longtitude : 2.234156] [altitude: 117.000000] </font>");
  ExpectPlace(point, 41.424724, 2.234156);
  EXPECT_DOUBLE_EQ(point.f_number.value(), 2.8);
  EXPECT_DOUBLE_EQ(point.focal_35mm.value(), 24.0);
  EXPECT_DOUBLE_EQ(point.altitude_m.value(), 117.0);
  EXPECT_FALSE(point.relative_altitude_m);
  EXPECT_NEAR(point.clock_s.value(), 1569522293.390617, 1e-6);
}

TEST(Subtitles, ALongFocalLengthWithDecimalsIsNoTenths) {
  EXPECT_DOUBLE_EQ(PointOf("[focal_len: 480.00] [iso: 100] [shutter: 1/100]").focal_35mm.value(), 480.0);
}

TEST(Subtitles, ReadLinesOfTheFirstDrones) {
  const TrackPoint point =
      PointOf("HOME(149.0251,-20.2532) 2017.08.05 14:11:51\nGPS(149.0251,-20.2533,16) BAROMETER:1.9\nISO:100 Shutter:60 EV: Fnum:F2.2");
  ExpectPlace(point, -20.2533, 149.0251);
  EXPECT_DOUBLE_EQ(point.relative_altitude_m.value(), 1.9);
  EXPECT_FALSE(point.altitude_m) << "16 are satellites";
  EXPECT_DOUBLE_EQ(point.exposure_time_s.value(), 1.0 / 60.0);
  EXPECT_DOUBLE_EQ(point.f_number.value(), 2.2);
  EXPECT_DOUBLE_EQ(point.iso.value(), 100.0);
}

TEST(Subtitles, ReadOneLineOfSurveyDrones) {
  const TrackPoint point = PointOf(
      "F/6.3, SS 60, ISO 100, EV 0, RTK (120.083799, 30.213635, 28), HOME (120.084146, 30.214243, 103.55m), D 75.36m, H 76.19m, H.S 0.30m/s, V.S "
      "0.00m/s, F.PRY (-5.3\xC2\xB0, 2.1\xC2\xB0, 28.3\xC2\xB0), G.PRY (-40.0\xC2\xB0, 0.0\xC2\xB0, 28.2\xC2\xB0)");
  ExpectPlace(point, 30.213635, 120.083799);
  EXPECT_DOUBLE_EQ(point.relative_altitude_m.value(), 76.19);
  EXPECT_DOUBLE_EQ(point.gimbal_pitch_deg.value(), -40.0);
  EXPECT_DOUBLE_EQ(point.gimbal_yaw_deg.value(), 28.2);
  EXPECT_DOUBLE_EQ(point.f_number.value(), 6.3);
  EXPECT_DOUBLE_EQ(point.exposure_time_s.value(), 1.0 / 60.0);
}

TEST(Subtitles, LatitudeIsFirstWhereTheThirdNumberHasAUnit) {
  ExpectPlace(PointOf("GPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M"), 36.6146, -6.1120);
  EXPECT_DOUBLE_EQ(PointOf("GPS(36.6146,-6.1120,0.0M) BAROMETER:0.3M").relative_altitude_m.value(), 0.3);
}

TEST(Subtitles, LettersNameTheAxes) {
  ExpectPlace(PointOf("GPS(W: 6.125, N: 36.5, 0010.50m)"), 36.5, -6.125);
  EXPECT_DOUBLE_EQ(PointOf("GPS(W: 6.125, N: 36.5, 0010.50m)").altitude_m.value(), 10.5);
}

TEST(Subtitles, WithoutTimesTheClockCounts) {
  const FlightTrack track = Parsed(
      "1\n2017.08.05 14:11:51,000,000\n[latitude : 31.45] [longtitude : 74.40]\n\n2\n2017.08.05 14:11:52,500,000\n[latitude : 31.46] [longtitude : "
      "74.40]\n");
  ASSERT_EQ(track.points.size(), 2U);
  EXPECT_DOUBLE_EQ(track.points[0].time_s, 0.0);
  EXPECT_NEAR(track.points[1].time_s, 1.5, 1e-6);
  EXPECT_DOUBLE_EQ(*track.points[1].latitude_deg, 31.46);
}

TEST(Subtitles, NoPlaceIsKeptBeforeTheReceiverKnowsIt) {
  const TrackPoint point = PointOf("[latitude: 0.000000] [longitude: 0.000000] [rel_alt: 1.000 abs_alt: 2.000]");
  EXPECT_FALSE(point.latitude_deg || point.longitude_deg);
  EXPECT_DOUBLE_EQ(point.relative_altitude_m.value(), 1.0);
  EXPECT_FALSE(PointOf("[latitude: 95.5] [longitude: 8.0] [rel_alt: 1.000 abs_alt: 2.000]").latitude_deg);
}

TEST(Subtitles, OfFilmsTellNothing) {
  EXPECT_TRUE(Parsed("1\n00:00:01,000 --> 00:00:04,000\nHello there.\nH and G.\n\n").points.empty());
  EXPECT_TRUE(Parsed("").points.empty());
}

TEST(Subtitles, SayHowFarPositionsAreRounded) {
  EXPECT_DOUBLE_EQ(Parsed("1\n00:00:00,000 --> 00:00:01,000\nGPS(149.0251,-20.2533,16)\n").position_step_deg, 1e-4);
  EXPECT_DOUBLE_EQ(Parsed("1\n00:00:00,000 --> 00:00:01,000\n[latitude: 1.123456] [longitude: 2.123456]\n").position_step_deg, 0.0);
}

TEST(Subtitles, OfEveryFrameAreThinnedOut) {
  std::string text = "\xEF\xBB\xBF";
  for (int i = 0; i < 300; ++i) {
    char block[200];
    std::snprintf(block, sizeof(block), "%d\r\n00:00:%02d,%03d --> 00:00:59,000\r\n[latitude: 1.5] [longitude: %.6f]\r\n\r\n", i + 1, i / 60,
                  i % 60 * 1000 / 60, 2.0 + 1e-6 * i);
    text += block;
  }
  const FlightTrack track = Parsed(text);
  EXPECT_GT(track.points.size(), 45U);
  EXPECT_LT(track.points.size(), 56U);
  EXPECT_NEAR(*StateAt(track, 2.5)->longitude_deg, 2.0 + 1e-6 * 150, 1e-7);
}

TEST(Subtitles, OtherFilesAreRefused) {
  EXPECT_NE(InputErrorOf([] { Parsed(std::string(100'000, 'x')); }).find("too long"), std::string::npos);
  EXPECT_NE(InputErrorOf([] { Parsed(std::string("a\0b\n", 4)); }).find("UTF-8"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::video
