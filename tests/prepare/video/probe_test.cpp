#include "prepare/video/probe.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::video {
namespace {

TEST(Probe, ReadsWhatFfprobeSays) {
  const VideoInfo info = ParseProbe(R"({"streams": [
    {"codec_type": "audio", "duration": "99.0"},
    {"codec_type": "video", "codec_name": "hevc", "width": 3840, "height": 2160, "avg_frame_rate": "30000/1001", "duration": "60.5",
     "field_order": "progressive", "disposition": {"attached_pic": 0}, "side_data_list": [{"side_data_type": "Display Matrix", "rotation": -90}]},
    {"codec_type": "video", "codec_name": "mjpeg", "width": 160, "height": 90, "disposition": {"attached_pic": 1}},
    {"codec_type": "subtitle"}],
    "format": {"duration": "60.6", "tags": {"creation_time": "2024-03-20T12:59:17.000000Z"}}})",
                                    "a.mp4");
  EXPECT_EQ(info.width, 2160) << "upright";
  EXPECT_EQ(info.height, 3840);
  EXPECT_EQ(info.rotation_deg, 90);
  EXPECT_DOUBLE_EQ(info.duration_s.value(), 60.5);
  EXPECT_NEAR(info.frames_per_s, 29.97, 0.01);
  EXPECT_FALSE(info.interlaced);
  EXPECT_TRUE(info.has_subtitles);
  EXPECT_DOUBLE_EQ(info.created_clock_s.value(), 1710939557.0);
}

TEST(Probe, SeesFieldsAndOblongPixels) {
  const VideoInfo info = ParseProbe(
      R"({"streams": [{"codec_type": "video", "width": 720, "height": 576, "sample_aspect_ratio": "16:11", "field_order": "tt", "avg_frame_rate": "0/0"}]})",
      "a.avi");
  EXPECT_EQ(info.width, 1047);
  EXPECT_EQ(info.height, 576);
  EXPECT_TRUE(info.interlaced);
  EXPECT_EQ(info.frames_per_s, 0.0);
  EXPECT_FALSE(info.duration_s || info.created_clock_s);
}

TEST(Probe, WithoutPicturesIsAnErrorThatNamesTheFile) {
  for (const char* text : {"", "[]", "{}", R"({"streams": [{"codec_type": "audio"}]})", R"({"streams": 3})",
                           R"({"streams": [{"codec_type": "video", "width": 99999999, "height": 2}]})"}) {
    const std::string error = InputErrorOf([&] { ParseProbe(text, "sound.mp4"); });
    EXPECT_NE(error.find("sound.mp4"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace skyquilt::prepare::video
