#include "bench/poses/photo_sets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "bench/poses/survey_size.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "simulate/simulate.h"
#include "simulate/world.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

// Twelve small photos of a hamlet and four of another, and the sets made from them.
class PhotoSets : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    base::Progress::SetQuiet(true);
    folder_ = new TemporaryFolder();
    Simulate("here", 1, 12);
    Simulate("there", 2, kIntruders);
  }
  static void TearDownTestSuite() { delete folder_; }
  static void Simulate(const std::string& name, int seed, size_t n) {
    base::ThreadPool threads(2);
    simulate::SimulateOptions options;
    options.place = "hamlet";
    options.seed = seed;
    options.image_width = 128;
    options.samples_per_pixel = 1;
    simulate::Simulate(options, *folder_ / name, threads, [n](const simulate::PlaceSpec& place, const simulate::World& world) {
      std::vector<simulate::PhotoPlan> photos = MiddlePhotos(simulate::PlanFlight(place, world.TakeoffHeight(place)), n);
      for (simulate::PhotoPlan& photo : photos) photo.finds_points = false;
      return photos;
    });
  }
  static fs::path Out(PhotoSet set) { return *folder_ / NameOf(set); }
  static TrueSet Make(PhotoSet set) { return MakePhotoSet(set, *folder_ / "here", *folder_ / "there", Out(set)); }
  static fs::path Original(const TruePhoto& photo) { return *folder_ / "here" / "images" / photo.name; }
  static survey::ColmapModel Model() { return survey::ReadColmapModel(*folder_ / "here" / "sparse" / "0"); }
  static bool SameFile(PhotoSet set, const TruePhoto& photo) { return base::ReadFile(Out(set) / photo.name) == base::ReadFile(Original(photo)); }

  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(PhotoSets, NamesAreThoseOfTheOption) {
  EXPECT_EQ(PhotoSetNames(), (std::vector<std::string>{"plain", "two_cameras", "turned", "blurred", "other_place", "no_tags", "solar_farm"}));
  for (const std::string& name : PhotoSetNames()) EXPECT_EQ(NameOf(PhotoSetOf(name)), name);
  EXPECT_NE(UsageErrorOf([] { PhotoSetOf("foggy"); }).find("turned"), std::string::npos);
}

TEST_F(PhotoSets, PlainPhotosAreThoseOfTheSurvey) {
  const TrueSet set = Make(PhotoSet::kPlain);
  const survey::ColmapModel model = Model();
  ASSERT_EQ(set.photos.size(), 12U);
  EXPECT_EQ(set.CountOurs(), 12U);
  EXPECT_NEAR(set.height_m, 45.0, 1.5);
  for (size_t i = 0; i < set.photos.size(); ++i) {
    EXPECT_TRUE(SameFile(PhotoSet::kPlain, set.photos[i]));
    EXPECT_EQ(set.photos[i].cam_from_enu.translation, model.images[i].cam_from_world.translation);
    EXPECT_EQ(set.photos[i].focal_px, model.cameras.at(1).FocalX());
  }
}

TEST_F(PhotoSets, TheSecondCameraSeesLessOfTheSame) {
  const TrueSet set = Make(PhotoSet::kTwoCameras);
  for (size_t i = 0; i < set.photos.size(); ++i) {
    const image::Image8 photo = image::LoadRgb8(Out(PhotoSet::kTwoCameras) / set.photos[i].name);
    EXPECT_EQ(SameFile(PhotoSet::kTwoCameras, set.photos[i]), i < 6);
    if (i < 6) continue;
    EXPECT_EQ(photo.width, 96);
    EXPECT_EQ(photo.height, 72);
    const survey::PhotoTags tags = survey::ReadPhotoTags(Out(PhotoSet::kTwoCameras) / set.photos[i].name);
    EXPECT_EQ(tags.model, "Simulated Tele");
    ASSERT_TRUE(tags.focal_length_35mm && tags.gps && tags.gimbal_yaw_deg);
    // The tags give the true focal length, to the millimetre.
    EXPECT_NEAR(*tags.focal_length_35mm, set.photos[i].focal_px / 96.0 * 36.0, 1.0);
  }
}

TEST_F(PhotoSets, EveryThirdPhotoIsTurned) {
  const TrueSet set = Make(PhotoSet::kTurned);
  const survey::ColmapModel model = Model();
  for (size_t i = 0; i < set.photos.size(); ++i) {
    int width = 0, height = 0;
    image::ReadImageSize(Out(PhotoSet::kTurned) / set.photos[i].name, &width, &height);
    const bool turned = i % 3 == 2;
    EXPECT_EQ(width, turned ? 96 : 128);
    EXPECT_EQ(height, turned ? 128 : 96);
    const geo::Rigid3d& before = model.images[i].cam_from_world;
    EXPECT_NEAR(set.photos[i].cam_from_enu.rotation.angularDistance(before.rotation), turned ? 0.5 * M_PI : 0.0, 1e-6);
    EXPECT_LT((set.photos[i].cam_from_enu.OriginInSource() - before.OriginInSource()).norm(), 1e-9);
    // The gimbal knows nothing of it.
    EXPECT_EQ(survey::ReadPhotoTags(Out(PhotoSet::kTurned) / set.photos[i].name).gimbal_yaw_deg,
              survey::ReadPhotoTags(Original(set.photos[i])).gimbal_yaw_deg);
  }
}

TEST_F(PhotoSets, EveryFourthPhotoIsBlurred) {
  const TrueSet set = Make(PhotoSet::kBlurred);
  const auto steps = [](const fs::path& file) {
    const image::Image8 photo = image::LoadRgb8(file);
    double sum = 0.0;
    for (int y = 1; y < photo.height; ++y) {
      for (int x = 0; x < photo.width; ++x) sum += std::abs(*photo.At(x, y) - *photo.At(x, y - 1));
    }
    return sum;
  };
  for (size_t i = 0; i < set.photos.size(); ++i) {
    EXPECT_EQ(SameFile(PhotoSet::kBlurred, set.photos[i]), i % 4 != 3);
    if (i % 4 == 3) {
      EXPECT_LT(steps(Out(PhotoSet::kBlurred) / set.photos[i].name), 0.8 * steps(Original(set.photos[i])));
    }
    EXPECT_TRUE(survey::ReadPhotoTags(Out(PhotoSet::kBlurred) / set.photos[i].name).gps);
  }
}

TEST_F(PhotoSets, IntrudersHaveTagsOfThisPlaceAndPixelsOfAnother) {
  const TrueSet set = Make(PhotoSet::kOtherPlace);
  ASSERT_EQ(set.photos.size(), 16U);
  EXPECT_EQ(set.CountOurs(), 12U);
  for (size_t i = 0; i < set.photos.size(); ++i) EXPECT_EQ(set.photos[i].intruder, i >= 12);
  const survey::PhotoTags tags = survey::ReadPhotoTags(Out(PhotoSet::kOtherPlace) / "OTHER_0002.jpg");
  const survey::PhotoTags like = survey::ReadPhotoTags(Original(set.photos[4]));
  ASSERT_TRUE(tags.gps && like.gps);
  EXPECT_EQ(tags.gps->latitude_deg, like.gps->latitude_deg);
  EXPECT_EQ(tags.gimbal_yaw_deg, like.gimbal_yaw_deg);
}

TEST_F(PhotoSets, PlaceTagsCanBeRemovedWhileTheLensStaysKnown) {
  const TrueSet set = Make(PhotoSet::kNoTags);
  for (const TruePhoto& photo : set.photos) {
    const survey::PhotoTags tags = survey::ReadPhotoTags(Out(PhotoSet::kNoTags) / photo.name);
    EXPECT_FALSE(tags.gps || tags.gimbal_yaw_deg || tags.gimbal_pitch_deg || tags.relative_altitude_m || tags.absolute_altitude_m);
    EXPECT_EQ(tags.focal_length_35mm, survey::ReadPhotoTags(Original(photo)).focal_length_35mm);
  }
  EXPECT_GT(set.height_m, 40.0);
}

}  // namespace
}  // namespace skyquilt::bench
