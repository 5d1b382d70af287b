// Flight logs as GPX and CSV, and the state between their points.
#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "prepare/video/csv_track.h"
#include "prepare/video/gpx.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::video {
namespace {

class FlightLogs : public InTemporaryFolder {
 protected:
  std::filesystem::path Written(const std::string& name, const std::string& text) {
    base::WriteFileAtomically(folder_ / name, text);
    return folder_ / name;
  }
};

TEST_F(FlightLogs, GpxHasPlacesByUtc) {
  const FlightTrack track = ReadGpx(Written("a.gpx", R"(<?xml version="1.0"?>
<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><wpt lat="1" lon="1"><time>2024-03-20T10:00:00Z</time></wpt>
<trk><trkseg><trkpt lat="47.25" lon="8.5"><ele>512.5</ele><time>2024-03-20T12:00:02+01:00</time></trkpt>
<trkpt lat="47.24" lon="8.5"><time>2024-03-20T11:00:00.500Z</time></trkpt><trkpt lat="47.26" lon="8.5"/></trkseg></trk></gpx>)"));
  ASSERT_EQ(track.points.size(), 2U);
  EXPECT_TRUE(track.by_clock);
  EXPECT_DOUBLE_EQ(track.points[1].time_s - track.points[0].time_s, 1.5);
  EXPECT_DOUBLE_EQ(*track.points[1].latitude_deg, 47.25);
  EXPECT_DOUBLE_EQ(track.points[1].altitude_m.value(), 512.5);
  EXPECT_FALSE(track.points[0].altitude_m);
}

TEST_F(FlightLogs, OtherXmlIsNoGpx) {
  EXPECT_NE(InputErrorOf([&] { ReadGpx(Written("a.gpx", "<kml/>")); }).find("no"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { ReadGpx(Written("b.gpx", "<gpx><trk>")); }).find("not XML"), std::string::npos);
}

TEST_F(FlightLogs, CsvHasColumnsByTheirNames) {
  const std::vector<FlightTrack> tracks = ReadCsvTracks(Written(
      "a.csv", "Time(millisecond),Latitude,Longitude,Height_above_takeoff(feet),gimbal_pitch(degrees)\n0,47.5,8.5,100,-90\n1000,47.6,8.5,200,\n"));
  ASSERT_EQ(tracks.size(), 1U);
  ASSERT_EQ(tracks[0].points.size(), 2U);
  EXPECT_FALSE(tracks[0].by_clock);
  EXPECT_DOUBLE_EQ(tracks[0].points[1].time_s, 1.0);
  EXPECT_NEAR(tracks[0].points[1].relative_altitude_m.value(), 60.96, 1e-9);
  EXPECT_DOUBLE_EQ(tracks[0].points[0].gimbal_pitch_deg.value(), -90.0);
  EXPECT_FALSE(tracks[0].points[1].gimbal_pitch_deg);
}

TEST_F(FlightLogs, EachRecordingOfALogBeginsAnew) {
  const std::vector<FlightTrack> tracks =
      ReadCsvTracks(Written("a.csv", "time_s;lat;lon;isVideo\n0;47;8;0\n1;47;8;1\n2;47;8;1\n3;47;8;0\n5;47;8;1\n6;47;8;1\n7;47;8;1\n"));
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[0].points.size(), 2U);
  EXPECT_DOUBLE_EQ(tracks[1].points.front().time_s, 0.0);
  EXPECT_DOUBLE_EQ(tracks[1].points.back().time_s, 2.0);
}

TEST_F(FlightLogs, CsvWithDatesIsByTheClock) {
  const std::vector<FlightTrack> tracks = ReadCsvTracks(Written("a.csv", "datetime(utc),latitude,longitude\n2024-03-20 11:00:00,47,8\n"));
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_TRUE(tracks[0].by_clock);
  EXPECT_DOUBLE_EQ(tracks[0].points[0].time_s, 1710932400.0);
}

TEST_F(FlightLogs, OtherTablesTellNothing) {
  EXPECT_TRUE(ReadCsvTracks(Written("a.csv", "frame,score\n1,2\n")).empty());
  EXPECT_TRUE(ReadCsvTracks(Written("b.csv", "")).empty());
}

TEST_F(FlightLogs, WrongNumbersAreNamedWithTheirLine) {
  const std::string error = InputErrorOf([&] { ReadCsvTracks(Written("a.csv", "time,lat,lon\n0,47,8\n1,forty,8\n")); });
  EXPECT_NE(error.find("line 3"), std::string::npos) << error;
}

TEST(FlightTrack, StatesAreInterpolatedAndUnknownFarFromPoints) {
  FlightTrack track;
  TrackPoint a{.time_s = 0.0}, b{.time_s = 2.0}, c{.time_s = 20.0};
  SetPosition(47.0, 179.9, a);
  SetPosition(47.5, -179.9, b);
  a.gimbal_yaw_deg = 350.0;
  b.gimbal_yaw_deg = 20.0;
  a.iso = 100.0;
  b.iso = 200.0;
  track.points = {a, b, c};
  const std::optional<TrackPoint> middle = StateAt(track, 1.5);
  ASSERT_TRUE(middle);
  EXPECT_DOUBLE_EQ(*middle->latitude_deg, 47.375);
  EXPECT_NEAR(*middle->longitude_deg, -179.95, 1e-9);
  EXPECT_NEAR(std::remainder(*middle->gimbal_yaw_deg - 12.5, 360.0), 0.0, 1e-9);
  EXPECT_DOUBLE_EQ(*middle->iso, 200.0);
  EXPECT_TRUE(StateAt(track, -1.0));
  EXPECT_FALSE(StateAt(track, -3.0));
  EXPECT_TRUE(StateAt(track, 3.9));
  EXPECT_FALSE(StateAt(track, 10.0)) << "in the middle of a gap";
  EXPECT_FALSE(StateAt(FlightTrack(), 0.0));
}

TEST(Clocks, AreReadInTheFormsOfDrones) {
  const double at_s = 1710939557.0;
  EXPECT_DOUBLE_EQ(FindClock("2024-03-20 12:59:17").value(), at_s);
  EXPECT_DOUBLE_EQ(FindClock("x 2024.3.20 12:59:17 y").value(), at_s);
  EXPECT_DOUBLE_EQ(FindClock("2024-03-20T14:59:17+02:00").value(), at_s);
  EXPECT_DOUBLE_EQ(FindClock("2024-03-20T12:59:17.000000Z").value(), at_s);
  EXPECT_DOUBLE_EQ(FindClock("2024-03-20t11:29:17-0130").value(), at_s);
  for (const char* wrong : {"", "2024-13-20 12:59:17", "2024-02-30 12:59:17", "2024-03-20", "24-03-20 12:59:17", "2024-03-20 25:00:00"}) {
    EXPECT_FALSE(FindClock(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::video
