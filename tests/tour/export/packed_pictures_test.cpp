#include "tour/export/packed_pictures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/tour/export/sample_tour_project.h"
#include "tour/pictures/make_pictures.h"

namespace skyquilt::tour {
namespace {

class Packed : public testing::Test {
 protected:
  Packed() {
    const std::vector<PictureRequest> requests = {StillAt({0.0, 0.0, 60.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), 60.0, 150, 101, "normal"),
                                                  PanoramaAt({0.0, 0.0, 60.0}, 2048, "normal")};
    const PictureFiles result = MakePictures(requests, counted_.field, folder_ / "work");
    stops_ = {{"one", result.files[0], result.files[1]}};
  }
  PicturePlan Fit(int64_t limit) { return FitPicturesOfStops(stops_, limit, threads_); }
  // Checks that the files have the bytes that were planned.
  nlohmann::json Write(const PicturePlan& plan) {
    int64_t bytes = 0;
    nlohmann::json manifest = WritePicturesOfStops(stops_, plan, folder_ / "data", [&bytes](int64_t n) { bytes += n; });
    EXPECT_EQ(bytes, plan.bytes);
    return manifest;
  }

  CountedField counted_;
  TemporaryFolder folder_;
  base::ThreadPool threads_{2};
  std::vector<StopPictures> stops_;
};

TEST_F(Packed, StillsLoseNothingWhereThereIsRoom) {
  const PicturePlan plan = Fit(100'000'000);
  EXPECT_TRUE(plan.fits && plan.lossless_stills);
  EXPECT_EQ(plan.quality, 92);
  EXPECT_EQ(plan.shrink, 1);
  const nlohmann::json manifest = Write(plan);
  EXPECT_EQ(ContentOf(folder_.path(), "stops/one/still.png"), OpenPicture(stops_[0].still).png);
  const nlohmann::json& still = manifest["one"]["still"];
  EXPECT_EQ(still["image"], "png");
  EXPECT_EQ(still["width"], 150);
  EXPECT_EQ(still["height"], 101);
  EXPECT_EQ(still["depth_width"], 75);
  EXPECT_EQ(still["depth_height"], 51);
  EXPECT_EQ(manifest["one"]["panorama"]["width"], 2048);
}

TEST_F(Packed, BecomeSmallerUntilTheyFit) {
  const int64_t most = Fit(100'000'000).bytes;
  int shrink = 1;
  for (const double share : {0.9, 0.5, 0.25}) {
    const auto limit = static_cast<int64_t>(share * static_cast<double>(most));
    const PicturePlan plan = Fit(limit);
    EXPECT_GE(plan.shrink, shrink);
    EXPECT_EQ(plan.fits, plan.bytes <= limit);
    shrink = plan.shrink;
    const nlohmann::json manifest = Write(plan);
    const nlohmann::json& panorama = manifest["one"]["panorama"];
    EXPECT_EQ(panorama["width"], 2048 / plan.shrink);
    EXPECT_EQ(panorama["height"], 1024 / plan.shrink);
    EXPECT_EQ(panorama["depth_width"], 1024 / plan.shrink);
  }
  EXPECT_GT(shrink, 1);
  const PicturePlan least = Fit(1000);
  EXPECT_FALSE(least.fits);
  EXPECT_EQ(least.shrink, 2) << "not below 1024 pixels";
}

// Depths are picked, not averaged, and keep their places: below the eye all lie on the ground.
TEST_F(Packed, ShrunkDepthsAreThoseOfTheSamePlaces) {
  const StoredPicture panorama = OpenPicture(stops_[0].panorama);
  const auto depths = [](const StoredPicture& picture) {
    return image::UnpackDepths(picture.depth, static_cast<size_t>(picture.depth_width) * static_cast<size_t>(picture.depth_height), picture.range,
                               image::DepthScale::kInverse);
  };
  const std::vector<float> all = depths(panorama);
  const StoredPicture small = Shrunk(panorama, 2);
  ASSERT_EQ(small.width, 1024);
  ASSERT_EQ(small.depth_width, 512);
  const std::vector<float> some = depths(small);
  for (size_t j = 0; j < 256; ++j) {
    for (size_t i = 0; i < 512; ++i) {
      const float expected = all[2 * j * 1024 + 2 * i], found = some[j * 512 + i];
      ASSERT_TRUE(std::isnan(expected) ? std::isnan(found) : std::abs(found - expected) <= 1e-4F * expected) << i << ", " << j;
    }
  }
}

}  // namespace
}  // namespace skyquilt::tour
