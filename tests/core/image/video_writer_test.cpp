#include "core/image/video_writer.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/video_facts.h"

namespace skyquilt::image {
namespace {

using VideoWriterTest = InTemporaryFolder;

TEST_F(VideoWriterTest, WithoutFfmpegItSaysWhatToInstall) {
  const std::string error = InputErrorOf([&] { VideoWriter(folder_.path() / "video.mp4", 64, 48, 10, "a-program-that-is-not-there"); });
  EXPECT_NE(error.find("apt install ffmpeg"), std::string::npos) << error;
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(VideoWriterTest, WritesH264) {
  if (!CanWriteVideos()) GTEST_SKIP() << "the program ffmpeg is not installed";
  const std::filesystem::path file = folder_.path() / "with space 'quote.mp4";
  VideoWriter video(file, 64, 48, 10);
  Image8 frame(64, 48, 3, 0);
  for (size_t i = 0; i < frame.data.size(); i += 3) frame.data[i] = 230;
  for (int i = 0; i < 5; ++i) video.Write(frame);
  EXPECT_FALSE(std::filesystem::exists(file));
  video.Close();
  const VideoFacts facts = Inspect(file);
  EXPECT_EQ(facts.frames, 5);
  EXPECT_EQ(facts.codec, "h264");
  EXPECT_GT(facts.middle[0], 180) << "red stays red";
  EXPECT_LT(facts.middle[2], 60);
}

TEST_F(VideoWriterTest, AProgramThatDiesIsReported) {
  const std::filesystem::path file = folder_.path() / "video.mp4";
  EXPECT_THROW(
      {
        VideoWriter video(file, 640, 480, 10, "false");
        const Image8 frame(640, 480, 3, 0);
        for (int i = 0; i < 50; ++i) video.Write(frame);
        video.Close();
      },
      base::InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(VideoWriterTest, LeavesNothingWhenAbandoned) {
  if (!CanWriteVideos()) GTEST_SKIP() << "the program ffmpeg is not installed";
  {
    VideoWriter video(folder_.path() / "video.mp4", 64, 48, 10);
    video.Write(Image8(64, 48, 3, 100));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

}  // namespace
}  // namespace skyquilt::image
