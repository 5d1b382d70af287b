// From a video file to photos, by ffmpeg. The videos fly over a made ground; their frames say their number in grey squares.
#include "prepare/video/video_frames.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"
#include "core/image/image.h"
#include "core/image/video_writer.h"
#include "core/survey/exif.h"
#include "prepare/video/frame_stream.h"
#include "prepare/video/probe.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/video_facts.h"

namespace skyquilt::prepare::video {
namespace {

namespace fs = std::filesystem;

constexpr int kVideoWidth = 160, kVideoHeight = 120, kFps = 10;
// Pixels that the ground moves down per frame: a quarter of the height in six frames.
constexpr int kSpeed_px = 5;

const image::Image8& Ground() {
  static const image::Image8 ground = [] {
    image::Image8 coarse(kVideoWidth / 4, 4000 / 4, 3);
    base::Random random(3);
    for (uint8_t& value : coarse.data) value = static_cast<uint8_t>(random.Below(256));
    return image::Resize(coarse, kVideoWidth, 4000);
  }();
  return ground;
}

// Eight squares along the upper edge: the bits of the frame's number.
void WriteNumber(int number, image::Image8& frame) {
  for (int bit = 0; bit < 8; ++bit) {
    for (int y = 0; y < 10; ++y) {
      for (int x = 0; x < 10; ++x) std::fill_n(frame.At(10 * bit + x, y), 3, static_cast<uint8_t>((number >> bit) % 2 == 1 ? 230 : 20));
    }
  }
}

int NumberOf(const image::Image8& frame) {
  int number = 0;
  for (int bit = 0; bit < 8; ++bit) number += *frame.At(10 * bit + 5, 5) > 125 ? 1 << bit : 0;
  return number;
}

fs::path MakeVideo(const fs::path& file, int n_frames) {
  image::VideoWriter video(file, kVideoWidth, kVideoHeight, kFps);
  for (int i = 0; i < n_frames; ++i) {
    image::Image8 frame(kVideoWidth, kVideoHeight, 3);
    const int first_row = Ground().height - kVideoHeight - kSpeed_px * i;
    std::copy_n(Ground().At(0, first_row), frame.data.size(), frame.data.data());
    WriteNumber(i, frame);
    video.Write(frame);
  }
  video.Close();
  return file;
}

std::vector<fs::path> FramesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(FramesFolder(folder))) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

class VideoFrames : public InTemporaryFolder {
 protected:
  void SetUp() override {
    if (!image::CanWriteVideos()) GTEST_SKIP() << "the program ffmpeg is not installed";
  }
};

TEST_F(VideoFrames, AreTheFramesOfTheirTimes) {
  const fs::path video = MakeVideo(folder_ / "flight one.mp4", 60);
  ProvideFrames({video}, {}, folder_ / "survey");
  const std::vector<fs::path> frames = FramesIn(folder_ / "survey");
  ASSERT_GE(frames.size(), 9U) << "59 times 5 of 120 pixels, a quarter each";
  ASSERT_LE(frames.size(), 13U);
  int before = -1;
  for (const fs::path& file : frames) {
    const std::string name = file.filename().string();
    ASSERT_TRUE(name.starts_with("flight_one_")) << name;
    const int number = NumberOf(image::LoadRgb8(file));
    EXPECT_EQ(std::stoi(name.substr(11, 8)), 1000 * number / kFps) << name;
    EXPECT_GT(number, before);
    before = number;
  }
  EXPECT_NE(base::ReadFile(folder_ / "survey" / "frames.csv").find("overlap by tracked corners"), std::string::npos);
}

TEST_F(VideoFrames, HaveTheTagsOfTheSubtitles) {
  const fs::path video = MakeVideo(folder_ / "a.mp4", 40);
  std::string text;
  for (int i = 0; i < 5; ++i) {
    text += fmt::format(
        "{}\n00:00:0{},000 --> 00:00:09,000\n2024-03-20 12:00:0{}\n[iso: 200] [shutter: 1/500.0] [fnum: 2.8] [focal_len: 24.00] [latitude: {:.6f}] "
        "[longitude: 8.500000] [rel_alt: 50.000 abs_alt: 480.000] [gb_yaw: 0.0 gb_pitch: -90.0 gb_roll: 0.0]\n\n",
        i + 1, i, i, 47.0 + 0.0002 * i);
  }
  base::WriteFileAtomically(folder_ / "a.SRT", text);
  ProvideFrames({video}, {}, folder_ / "survey");
  const std::vector<fs::path> frames = FramesIn(folder_ / "survey");
  EXPECT_GE(frames.size(), 6U) << "80 m, a quarter of 56 m each";
  EXPECT_LE(frames.size(), 9U);
  EXPECT_NE(base::ReadFile(folder_ / "survey" / "frames.csv").find("overlap by place and height"), std::string::npos);
  for (const fs::path& file : frames) {
    const double time_s = 0.1 * NumberOf(image::LoadRgb8(file));
    const survey::PhotoTags tags = survey::ReadPhotoTags(file);
    ASSERT_TRUE(tags.gps) << file;
    EXPECT_NEAR(tags.gps->latitude_deg, 47.0 + 0.0002 * time_s, 1e-8);
    EXPECT_NEAR(tags.gps->height_m, 480.0, 1e-3);
    EXPECT_NEAR(tags.relative_altitude_m.value(), 50.0, 1e-3);
    EXPECT_NEAR(tags.gimbal_pitch_deg.value(), -90.0, 1e-3);
    EXPECT_NEAR(tags.exposure.time_s.value(), 0.002, 1e-9);
    EXPECT_NEAR(tags.focal_length_35mm.value(), 24.0, 1e-9);
    EXPECT_NEAR(tags.capture_time_s.value(), 1710936000.0 + time_s, 1e-3);
  }
}

TEST_F(VideoFrames, AreFinishedFromWhereTheyWereInterrupted) {
  const fs::path video = MakeVideo(folder_ / "a.mp4", 60), survey = folder_ / "survey";
  ProvideFrames({video}, {}, survey);
  const std::vector<fs::path> frames = FramesIn(survey);
  const std::string table = base::ReadFile(survey / "frames.csv");
  const auto kept = fs::last_write_time(frames[0]);
  // As a kill leaves it: some are there, one is unfinished, the table is not written.
  fs::remove(survey / "frames.csv");
  fs::remove(frames[3]);
  fs::remove(frames.back());
  base::WriteFileAtomically(FramesFolder(survey) / ("." + frames[3].filename().string()), "half");
  ProvideFrames({video}, {}, survey);
  EXPECT_EQ(FramesIn(survey), frames);
  EXPECT_EQ(base::ReadFile(survey / "frames.csv"), table);
  EXPECT_EQ(fs::last_write_time(frames[0]), kept);
  // Other options make others.
  ProvideFrames({video}, {.overlap = 0.5}, survey);
  EXPECT_LT(FramesIn(survey).size(), frames.size());
}

TEST_F(VideoFrames, KeepTheLimitAndTheSize) {
  const std::vector<fs::path> videos = {MakeVideo(folder_ / "a.mp4", 60), MakeVideo(folder_ / "b.mp4", 60)};
  ProvideFrames(videos, {.limit = 9, .size = 80}, folder_ / "survey");
  const std::vector<fs::path> frames = FramesIn(folder_ / "survey");
  EXPECT_LE(frames.size(), 9U);
  EXPECT_GE(frames.size(), 5U);
  const image::Image8 frame = image::LoadRgb8(frames.front());
  EXPECT_EQ(frame.width, 80);
  EXPECT_EQ(frame.height, 60);
}

TEST_F(VideoFrames, OfAVideoThatEndsHalfwayAreThoseBefore) {
  const fs::path whole = MakeVideo(folder_ / "a.mp4", 100), half = folder_ / "half.mp4";
  const std::string bytes = base::ReadFile(whole);
  base::WriteFileAtomically(half, bytes.substr(0, bytes.size() / 2));
  ProvideFrames({half}, {}, folder_ / "survey");
  const std::vector<fs::path> frames = FramesIn(folder_ / "survey");
  EXPECT_GE(frames.size(), 4U);
  EXPECT_LE(NumberOf(image::LoadRgb8(frames.back())), 80);
  for (const fs::path& file : frames) EXPECT_EQ(image::LoadRgb8(file).width, kVideoWidth) << file;
  base::WriteFileAtomically(half, bytes.substr(0, 300));
  const std::string error = InputErrorOf([&] { ProvideFrames({half}, {}, folder_ / "other"); });
  EXPECT_NE(error.find("half.mp4"), std::string::npos) << error;
  EXPECT_FALSE(fs::exists(FramesFolder(folder_ / "other")));
}

TEST_F(VideoFrames, OfACameraThatStandsStillAreTooFew) {
  const fs::path file = folder_ / "still.mp4";
  {
    image::VideoWriter video(file, kVideoWidth, kVideoHeight, kFps);
    image::Image8 frame(kVideoWidth, kVideoHeight, 3);
    std::copy_n(Ground().At(0, 0), frame.data.size(), frame.data.data());
    for (int i = 0; i < 30; ++i) video.Write(frame);
    video.Close();
  }
  EXPECT_NE(InputErrorOf([&] { ProvideFrames({file}, {}, folder_ / "survey"); }).find("only 1 place"), std::string::npos);
}

TEST_F(VideoFrames, HaveTheirTimesWhateverTheRate) {
  // Every third frame is left out: the others keep their times.
  const fs::path even = MakeVideo(folder_ / "even.mp4", 40), uneven = folder_ / "uneven.mkv";
  OutputOf("ffmpeg",
           {"-v", "error", "-i", even.string(), "-vf", "select='mod(n,3)'", "-fps_mode", "passthrough", "-c:v", "libx264", uneven.string()});
  FrameStream stream({.video = uneven, .width = kVideoWidth, .height = kVideoHeight});
  std::optional<double> first_s;
  int n_frames = 0;
  for (VideoFrame frame; stream.Next(&frame); ++n_frames) {
    if (!first_s) first_s = frame.time_s;
    EXPECT_NEAR(frame.time_s - *first_s, 0.1 * (NumberOf(frame.pixels) - 1), 0.002);
  }
  EXPECT_EQ(n_frames, 26);
  EXPECT_EQ(stream.Problem(), "");
}

TEST_F(VideoFrames, OfATransportStreamAreExactToo) {
  const fs::path whole = MakeVideo(folder_ / "a.mp4", 60), stream = folder_ / "a.ts";
  OutputOf("ffmpeg", {"-v", "error", "-i", whole.string(), "-c", "copy", stream.string()});
  ProvideFrames({stream}, {}, folder_ / "survey");
  const std::vector<fs::path> frames = FramesIn(folder_ / "survey");
  EXPECT_GE(frames.size(), 9U);
  for (const fs::path& file : frames) {
    EXPECT_EQ(std::stoi(file.filename().string().substr(2, 8)), 1000 * NumberOf(image::LoadRgb8(file)) / kFps) << file;
  }
}

TEST(Tags, ComeFromTheState) {
  TrackPoint state;
  SetPosition(47.0, 8.5, state);
  state.relative_altitude_m = 50.0;
  state.altitude_m = 480.0;
  state.iso = 200.0;
  const survey::PhotoTags tags = TagsOf(state, 1e-4);
  EXPECT_DOUBLE_EQ(tags.gps->height_m, 480.0);
  EXPECT_DOUBLE_EQ(tags.absolute_altitude_m.value(), 480.0);
  EXPECT_DOUBLE_EQ(tags.exposure.iso.value(), 200.0);
  EXPECT_GT(tags.horizontal_accuracy_m.value(), 4.0) << "four decimals are eleven metres";
  EXPECT_FALSE(TagsOf(state, 0.0).horizontal_accuracy_m);
  state.altitude_m.reset();
  EXPECT_TRUE(std::isnan(TagsOf(state, 0.0).gps->height_m));
}

}  // namespace
}  // namespace skyquilt::prepare::video
