#include "simulate/flights/video_flight.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "simulate/simulate.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::simulate {
namespace {

constexpr int kVideoFps = 5;

class FilmedFlight : public InTemporaryFolder {
 protected:
  const PlaceSpec place_ = ResolvePlace({.place = "hamlet"});
  const std::vector<PhotoPlan> photos_ = PlanFlight(place_, 0.0);
  const std::vector<PhotoPlan> frames_ = PlanVideo(place_, photos_, kVideoFps);
};

TEST_F(FilmedFlight, HasAFrameEveryFifthOfASecond) {
  ASSERT_GT(frames_.size(), 100U);
  for (size_t i = 0; i < frames_.size(); ++i) EXPECT_NEAR(frames_[i].time_s, static_cast<double>(i) / kVideoFps, 1e-9);
}

TEST_F(FilmedFlight, PassesByEveryPhotoWithoutAJump) {
  const double step_m = place_.speed_mps / kVideoFps;
  for (const PhotoPlan& photo : photos_) {
    double nearest_m = 1e9;
    for (const PhotoPlan& frame : frames_) {
      nearest_m = std::min(nearest_m, (frame.cam_from_enu.OriginInSource() - photo.cam_from_enu.OriginInSource()).norm());
    }
    EXPECT_LE(nearest_m, step_m) << photo.name;
  }
  for (size_t i = 1; i < frames_.size(); ++i) {
    EXPECT_LE((frames_[i].cam_from_enu.OriginInSource() - frames_[i - 1].cam_from_enu.OriginInSource()).norm(), 1.001 * step_m) << i;
    EXPECT_LE(std::abs(std::remainder(frames_[i].yaw_deg - frames_[i - 1].yaw_deg, 360.0)), 9.1) << i;
  }
}

TEST_F(FilmedFlight, SubtitlesHaveWhatTheTagsOfPhotosHave) {
  const geo::EnuFrame frame({47.0, 8.5, 400.0});
  WriteSubtitles(frames_, kVideoFps, place_.camera, frame, folder_ / "a.SRT");
  const std::string text = base::ReadFile(folder_ / "a.SRT");
  EXPECT_NE(
      text.find("2\n00:00:00,200 --> 00:00:00,400\n<font size=\"28\">FrameCnt: 2, DiffTime: 200ms\n2026-05-04 10:00:00.200\n[iso: 100] [shutter: 1/"),
      std::string::npos)
      << text.substr(0, 600);
  EXPECT_NE(text.find("[latitude: 47.000"), std::string::npos);
  EXPECT_NE(text.find("[longitude: 8.500"), std::string::npos);
  for (const char* key : {"[rel_alt: 4", " abs_alt: 44", "[gb_yaw: ", " gb_pitch: -8"}) EXPECT_NE(text.find(key), std::string::npos) << key;
  EXPECT_EQ(static_cast<size_t>(std::count(text.begin(), text.end(), '>')) / 3, frames_.size()) << "an arrow and a font in each block";
}

TEST_F(FilmedFlight, NeedsASurveyOfEvenSize) {
  base::ThreadPool threads(1);
  EXPECT_NE(ErrorOf<base::UsageError>([&] { Simulate({.place = "hamlet", .image_width = 33, .video_fps = 5}, folder_ / "a", threads); }).find("even"),
            std::string::npos);
  EXPECT_NE(
      ErrorOf<base::UsageError>([&] { Simulate({.place = "hamlet", .flight = "street", .video_fps = 5}, folder_ / "b", threads); }).find("survey"),
      std::string::npos);
}

}  // namespace
}  // namespace skyquilt::simulate
