#include "worker/rays/photo_segments.h"

#include <gtest/gtest.h>

#include <set>

#include "core/base/random.h"

namespace skyquilt::worker {
namespace {

// Grey roof on the left, red roof in the middle, grass on the right, below them a strip of strong noise.
image::Image8 MadePhoto() {
  image::Image8 photo(90, 60, 3);
  base::Random random(7);
  for (int y = 0; y < photo.height; ++y) {
    for (int x = 0; x < photo.width; ++x) {
      uint8_t* p = photo.At(x, y);
      const uint8_t grey[3] = {120, 118, 122}, red[3] = {170, 70, 60}, green[3] = {80, 130, 60};
      const uint8_t* colour = x < 30 ? grey : x < 60 ? red : green;
      for (int c = 0; c < 3; ++c) p[c] = y < 40 ? static_cast<uint8_t>(colour[c] + random.Below(3)) : static_cast<uint8_t>(random.Below(256));
    }
  }
  return photo;
}

std::set<uint16_t> LabelsIn(const image::BasicImage<uint16_t>& labels, int x0, int x1, int y0, int y1) {
  std::set<uint16_t> found;
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) found.insert(*labels.At(x, y));
  }
  return found;
}

TEST(PhotoSegments, AreTheRoofs) {
  const image::BasicImage<uint16_t> labels = SegmentPhoto(MadePhoto());
  const std::set<uint16_t> grey = LabelsIn(labels, 3, 27, 3, 36), red = LabelsIn(labels, 33, 57, 3, 36);
  ASSERT_EQ(grey.size(), 1U);
  ASSERT_EQ(red.size(), 1U);
  EXPECT_NE(*grey.begin(), 0);
  EXPECT_NE(*red.begin(), 0);
  EXPECT_NE(*grey.begin(), *red.begin());
}

TEST(PhotoSegments, LeaveOutGrassAndStrongTexture) {
  const image::BasicImage<uint16_t> labels = SegmentPhoto(MadePhoto());
  EXPECT_EQ(LabelsIn(labels, 63, 90, 3, 36), std::set<uint16_t>{0}) << "grass";
  int in_noise = 0;
  for (int y = 44; y < 60; ++y) {
    for (int x = 0; x < 90; ++x) in_noise += *labels.At(x, y) != 0 ? 1 : 0;
  }
  EXPECT_LT(in_noise, 20) << "noise, in which few pixels resemble all their neighbours";
  EXPECT_EQ(LabelsIn(labels, 29, 31, 3, 36), std::set<uint16_t>{0}) << "the border between two segments";
}

TEST(PhotoSegments, OfAPhotoInOneColourCoverIt) {
  const image::BasicImage<uint16_t> labels = SegmentPhoto(image::Image8(40, 30, 3, 99));
  EXPECT_EQ(LabelsIn(labels, 1, 39, 1, 29).size(), 1U);
  EXPECT_NE(*labels.At(20, 15), 0);
  EXPECT_EQ(*labels.At(0, 0), 0);
}

}  // namespace
}  // namespace skyquilt::worker
