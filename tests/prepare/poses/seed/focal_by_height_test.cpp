#include "prepare/poses/seed/focal_by_height.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/prepare/poses/seed/made_survey.h"

namespace skyquilt::test {
namespace {

using namespace prepare::poses;

constexpr double kUnknownHeight_m = std::numeric_limits<double>::quiet_NaN();

// Photos without focal length tags; the lens begins with so many times the true focal length.
MadeSurvey MakeUntagged(double guess, double pitch_deg) {
  MadeSurvey made = MakeSurvey({.strips = 3, .per_strip = 4, .pitch_deg = pitch_deg, .points_per_photo = 150, .angle_noise_deg = 1.0, .seed = 11});
  for (auto& [id, lens] : made.input.cameras) {
    lens = ScaledFocal(lens, guess * made.cameras[0].FocalX() / lens.camera.FocalX());
    lens.focal_is_known = false;
  }
  for (size_t i = 0; i < made.input.photos.size(); ++i) made.input.photos[i].relative_altitude_m = made.cam_from_enu[i].OriginInSource().z();
  return made;
}

TEST(FocalByHeight, FindsTheFocalLengthFromAnyGuess) {
  for (const double guess : {0.3, 0.6, 1.0, 1.7, 6.6}) {
    const MadeSurvey made = MakeUntagged(guess, -90.0);
    const std::optional<double> factor = FocalFactorByHeight(made.input);
    ASSERT_TRUE(factor) << guess;
    EXPECT_NEAR(*factor * guess, 1.0, 0.12) << guess;
  }
}

TEST(FocalByHeight, SaysNothingWithoutHeights) {
  MadeSurvey made = MakeUntagged(1.7, -90.0);
  for (SeedPhoto& photo : made.input.photos) photo.relative_altitude_m = 0.0;
  EXPECT_FALSE(FocalFactorByHeight(made.input));
  for (SeedPhoto& photo : made.input.photos) photo.relative_altitude_m.reset();
  EXPECT_FALSE(FocalFactorByHeight(made.input));
  for (SeedPhoto& photo : made.input.photos) {
    photo.relative_altitude_m = 80.0;
    photo.gps.reset();
  }
  EXPECT_FALSE(FocalFactorByHeight(made.input));
}

TEST(FocalByHeight, ScalesBothFocalLengthsOfALens) {
  const SeedLens lens{{camera::CameraModel::kOpencv, 800, 600, {500.0, 510.0, 400.0, 300.0, 0.01, 0.0, 0.0, 0.0}}, false};
  const SeedLens scaled = ScaledFocal(lens, 2.0);
  EXPECT_NEAR(scaled.camera.FocalX(), 1000.0, 1e-9);
  EXPECT_NEAR(scaled.camera.FocalY(), 1020.0, 1e-9);
  EXPECT_EQ(scaled.camera.params[4], 0.01);
  EXPECT_TRUE(scaled.focal_is_known);
}

TEST(FocalByHeight, MeasuresHeightsAboveThePointsOfEachPhoto) {
  SeedInput input;
  survey::ColmapModel model;
  for (uint32_t id = 1; id <= 4; ++id) {
    SeedPhoto& photo = input.photos.emplace_back();
    photo.image_id = id;
    photo.relative_altitude_m = 40.0;
    survey::ColmapImage image;
    image.id = id;
    image.cam_from_world = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, -90.0 - id)};
    model.images.push_back(image);
    survey::ColmapPoint point;
    point.x_in_world = Eigen::Vector3d(0.0, 0.0, 10.0 + id);
    point.image_ids = {id};
    model.points.push_back(point);
  }
  const HeightAboveTakeOff height = HeightsInModel(input, model);
  EXPECT_EQ(height.n, 4);
  EXPECT_NEAR(height.found_m, 80.0, 1e-9);
  EXPECT_NEAR(height.ratio, 2.0, 1e-9);
  EXPECT_TRUE(height.Contradicts());
  EXPECT_FALSE(HeightsInModel({}, model).Known());
  // By the tags the flight was twice as long.
  for (size_t i = 0; i < 4; ++i) {
    constexpr double kMetresPerDegree = 111'000.0;
    const double north_m = 20.0 * static_cast<double>(i);
    input.photos[i].gps = geo::Geodetic{north_m / kMetresPerDegree, 8.0, 0.0};
    model.images[i].cam_from_world.translation.y() = -0.5 * north_m;
  }
  EXPECT_NEAR(HeightsInModel(input, model).ratio, 4.0, 0.05);
}

TEST(CompareHeights, LimitsAndUnknownValues) {
  const auto compare = [](double found_m, double tagged_m) { return CompareHeights({found_m, found_m, found_m}, {tagged_m, tagged_m, tagged_m}); };
  EXPECT_FALSE(compare(104.0, 100.0).Notable());
  EXPECT_TRUE(compare(115.0, 100.0).Notable());
  EXPECT_FALSE(compare(115.0, 100.0).Differs());
  EXPECT_TRUE(compare(70.0, 100.0).Differs());
  EXPECT_FALSE(compare(70.0, 100.0).Contradicts());
  EXPECT_TRUE(compare(60.0, 100.0).Contradicts());
  EXPECT_TRUE(compare(227.0, 45.0).Contradicts());
  EXPECT_FALSE(compare(7.5, 5.0).Notable());  // few metres
  EXPECT_FALSE(compare(kUnknownHeight_m, 45.0).Known());
  EXPECT_FALSE(compare(45.0, kUnknownHeight_m).Known());
  EXPECT_FALSE(compare(45.0, 0.0).Known());
  EXPECT_FALSE(compare(-45.0, 45.0).Known());
  EXPECT_FALSE(CompareHeights({}, {}).Notable());
}

}  // namespace
}  // namespace skyquilt::test
