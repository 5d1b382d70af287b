#include "prepare/video/find_tracks.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "prepare/video/find_videos.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::video {
namespace {

class FilesOfVideos : public InTemporaryFolder {
 protected:
  void Add(const std::string& name, const std::string& text = "x") {
    std::filesystem::create_directories((folder_ / name).parent_path());
    base::WriteFileAtomically(folder_ / name, text);
  }
  static std::vector<std::string> Names(const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> names;
    for (const std::filesystem::path& file : files) names.push_back(file.filename().string());
    return names;
  }
};

TEST_F(FilesOfVideos, BesideAVideoAreFoundInAnyCase) {
  for (const char* name : {"DJI_1.MP4", "dji_1.srt", "DJI_1.csv", "DJI_2.SRT", "walk.gpx"}) Add(name);
  EXPECT_EQ(Names(FilesBeside(folder_ / "DJI_1.MP4")), (std::vector<std::string>{"dji_1.srt", "walk.gpx", "DJI_1.csv"}));
  Add("other.gpx");
  EXPECT_EQ(Names(FilesBeside(folder_ / "DJI_1.MP4")), (std::vector<std::string>{"dji_1.srt", "DJI_1.csv"})) << "which log is not known";
}

TEST_F(FilesOfVideos, AFolderOfVideosGivesThemAllButSmallCopies) {
  for (const char* name : {"b/2.MP4", "a/1.mov", "a/1.LRF", "a/._1.mov", "notes.txt"}) Add(name);
  EXPECT_EQ(Names(FindVideos({folder_.path()})), (std::vector<std::string>{"1.mov", "2.MP4"}));
  Add("photo.jpg");
  EXPECT_TRUE(FindVideos({folder_.path()}).empty()) << "photos are the input";
}

TEST_F(FilesOfVideos, OtherInputsAreRefused) {
  Add("1.mp4");
  Add("notes.txt");
  EXPECT_NE(InputErrorOf([&] { FindVideos({folder_ / "2.mp4"}); }).find("no such"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { FindVideos({folder_ / "1.mp4", folder_ / "notes.txt"}); }).find("no video"), std::string::npos);
  EXPECT_THROW(FindVideos({folder_ / "1.mp4", folder_.path()}), base::UsageError);
}

TEST_F(FilesOfVideos, AnotherFileBesideChangesTheIdentity) {
  Add("1.mp4");
  const std::string before = VideosIdentity({folder_ / "1.mp4"});
  EXPECT_EQ(VideosIdentity({folder_ / "1.mp4"}), before);
  Add("1.srt");
  EXPECT_NE(VideosIdentity({folder_ / "1.mp4"}), before);
}

constexpr const char* kGpx =
    R"(<gpx><trk><trkseg><trkpt lat="47" lon="8"><time>2024-03-20T10:00:00Z</time></trkpt>
<trkpt lat="47.1" lon="8"><time>2024-03-20T10:00:02Z</time></trkpt></trkseg></trk></gpx>)";

TEST_F(FilesOfVideos, ALogByUtcIsMovedToTheVideo) {
  Add("1.mp4");
  Add("1.gpx", kGpx);
  VideoInfo info{.width = 4, .height = 3, .duration_s = 2.0, .created_clock_s = FindClock("2024-03-20 12:00:00")};
  std::vector<FlightTrack> tracks = FindTracks(folder_ / "1.mp4", info, 0.0);
  ASSERT_EQ(tracks.size(), 1U) << "two hours later by the local time of the camera";
  EXPECT_DOUBLE_EQ(tracks[0].points[1].time_s, 2.0);
  EXPECT_DOUBLE_EQ(*StateByAll(tracks, 1.0).latitude_deg, 47.05);
  tracks = FindTracks(folder_ / "1.mp4", info, 1.0);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_DOUBLE_EQ(tracks[0].points[1].time_s, 1.0) << "the clock was a second slow";
  info.created_clock_s = FindClock("2024-03-25 12:00:00");
  EXPECT_TRUE(FindTracks(folder_ / "1.mp4", info, 0.0).empty());
  info.created_clock_s.reset();
  EXPECT_TRUE(FindTracks(folder_ / "1.mp4", info, 0.0).empty());
}

TEST_F(FilesOfVideos, WhatOneDoesNotKnowComesFromTheNext) {
  Add("1.mp4");
  Add("1.SRT", "1\n00:00:00,000 --> 00:00:02,000\nISO:100 Shutter:60 EV: Fnum:2.2\n\n");
  Add("1.csv", "time,lat,lon,height\n0,47,8,50\n");
  const std::vector<FlightTrack> tracks = FindTracks(folder_ / "1.mp4", {.duration_s = 2.0}, 0.0);
  ASSERT_EQ(tracks.size(), 2U);
  const TrackPoint state = StateByAll(tracks, 0.5);
  EXPECT_DOUBLE_EQ(state.iso.value(), 100.0);
  EXPECT_DOUBLE_EQ(state.latitude_deg.value(), 47.0);
  EXPECT_DOUBLE_EQ(state.relative_altitude_m.value(), 50.0);
}

TEST_F(FilesOfVideos, DamagedOnesAreLeftOut) {
  Add("1.mp4");
  Add("1.gpx", "<gpx><trk>");
  Add("1.csv", "time,lat,lon\n0,x,8\n");
  EXPECT_TRUE(FindTracks(folder_ / "1.mp4", {.duration_s = 2.0}, 0.0).empty());
}

TEST(ClockShift, IsTheLeastThatCovers) {
  EXPECT_DOUBLE_EQ(ClockShift(1000.0, 60.0, 900.0, 2000.0).value(), 0.0);
  EXPECT_DOUBLE_EQ(ClockShift(1000.0, 60.0, 1000.0 + 7200.0, 1060.0 + 7200.0).value(), 7200.0);
  EXPECT_DOUBLE_EQ(ClockShift(1000.0, 60.0, 1000.0 - 12600.0, 1060.0 - 12600.0).value(), -12600.0) << "three and a half hours";
  EXPECT_FALSE(ClockShift(1000.0, 60.0, 1300.0, 1360.0));
  EXPECT_FALSE(ClockShift(1000.0, 60.0, 1000.0 + 1e6, 1060.0 + 1e6));
}

}  // namespace
}  // namespace skyquilt::prepare::video
