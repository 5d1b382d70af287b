#include "bench/poses/survey_size.h"

#include <gtest/gtest.h>

namespace skyquilt::bench {
namespace {

// Lines of `per_line` photos, numbered in `line` and by time.
std::vector<simulate::PhotoPlan> Lines(int lines, int per_line) {
  std::vector<simulate::PhotoPlan> photos;
  for (int i = 0; i < lines * per_line; ++i) {
    simulate::PhotoPlan photo;
    photo.name = std::to_string(i);
    photo.line = i / per_line;
    photo.time_s = i;
    photo.cam_from_enu = simulate::PoseFromGimbal({40.0 * photo.line, 15.0 * (i % per_line), 80.0}, 0.0, -90.0, 0.0);
    photos.push_back(photo);
  }
  return photos;
}

TEST(MiddlePhotos, AreARectangleInTheOrderOfCapture) {
  // The middle third of both directions.
  const std::vector<simulate::PhotoPlan> chosen = MiddlePhotos(Lines(9, 15), 15);
  ASSERT_EQ(chosen.size(), 15U);
  for (size_t i = 0; i < chosen.size(); ++i) {
    EXPECT_EQ(chosen[i].line, 3 + static_cast<int>(i) / 5);
    EXPECT_EQ(chosen[i].time_s, 15.0 * chosen[i].line + 5.0 + static_cast<double>(i % 5));
  }
}

TEST(MiddlePhotos, AreAllWhenThereAreNoMore) {
  EXPECT_EQ(MiddlePhotos(Lines(2, 3), 6).size(), 6U);
  EXPECT_EQ(MiddlePhotos(Lines(2, 3), 60).size(), 6U);
  EXPECT_EQ(MiddlePhotos(Lines(1, 9), 3).front().name, "3");
  EXPECT_EQ(MiddlePhotos(Lines(2, 3), 0).size(), 0U);
}

}  // namespace
}  // namespace skyquilt::bench
