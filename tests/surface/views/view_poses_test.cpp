#include "surface/views/view_poses.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/support/temporary_folder.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

// All pixel centres of the pinhole project into the photo.
bool StaysInside(const ViewPose& pose, const camera::Camera& camera) {
  for (int y = 0; y < pose.height; ++y) {
    for (int x = 0; x < pose.width; ++x) {
      const auto pixel = camera.ImgFromCam({(x + 0.5 - pose.cx) / pose.focal_px, (y + 0.5 - pose.cy) / pose.focal_px, 1.0});
      if (!pixel || pixel->x() < 0.0 || pixel->y() < 0.0 || pixel->x() > camera.width || pixel->y() > camera.height) return false;
    }
  }
  return true;
}

TEST(InnerRectangle, OfAPinholeIsItsWholeImage) {
  const camera::Camera camera{camera::CameraModel::kPinhole, 200, 100, {100.0, 100.0, 90.0, 60.0}};
  const std::optional<TangentRectangle> r = InnerRectangle(camera);
  ASSERT_TRUE(r);
  EXPECT_NEAR(r->left, -0.9, 1e-9);
  EXPECT_NEAR(r->right, 1.1, 1e-9);
  EXPECT_NEAR(r->top, -0.6, 1e-9);
  EXPECT_NEAR(r->bottom, 0.4, 1e-9);
  const ViewPose pose = PinholeOf(*r, 100.0, {});
  EXPECT_EQ(pose.width, 200);
  EXPECT_EQ(pose.height, 100);
  EXPECT_NEAR(pose.cx, 90.0, 1e-6);
  EXPECT_NEAR(pose.cy, 60.0, 1e-6);
}

TEST(InnerRectangle, StaysInsideWithStrongDistortion) {
  for (const double k : {-0.35, -0.25, -0.1, 0.1, 0.4}) {
    const camera::Camera camera{camera::CameraModel::kSimpleRadial, 200, 150, {130.0, 104.0, 70.0, k}};
    const std::optional<TangentRectangle> r = InnerRectangle(camera);
    ASSERT_TRUE(r) << k;
    const ViewPose pose = PinholeOf(*r, 60.0, {});
    EXPECT_TRUE(StaysInside(pose, camera)) << k;
    // Not by showing next to nothing.
    EXPECT_GT(pose.width / pose.focal_px, 0.7 * 200 / 130.0) << k;
    EXPECT_GT(pose.height / pose.focal_px, 0.7 * 150 / 130.0) << k;
  }
}

RC_GTEST_PROP(InnerRectangle, StaysInsideOfAnyLens, ()) {
  const auto number = [](int low, int high, double unit) { return *rc::gen::inRange(low, high) * unit; };
  camera::Camera camera{camera::CameraModel::kOpencv, 160, 120, {}};
  camera.params = {number(80, 300, 1.0),  number(80, 300, 1.0),  number(60, 100, 1.0),    number(40, 80, 1.0),
                   number(-30, 30, 0.01), number(-10, 10, 0.01), number(-30, 30, 0.0001), number(-30, 30, 0.0001)};
  const std::optional<TangentRectangle> r = InnerRectangle(camera);
  RC_CLASSIFY(r.has_value());
  if (r) RC_ASSERT(StaysInside(PinholeOf(*r, 50.0, {}), camera));
}

TEST(InnerRectangle, OfAFisheyeEndsAt55Degrees) {
  const camera::Camera camera{camera::CameraModel::kOpencvFisheye, 400, 400, {110.0, 110.0, 200.0, 200.0, 0.0, 0.0, 0.0, 0.0}};
  const std::optional<TangentRectangle> r = InnerRectangle(camera);
  ASSERT_TRUE(r);
  const double limit = std::tan(55.0 * std::numbers::pi / 180.0);
  EXPECT_NEAR(r->right, limit, 1e-9);
  EXPECT_NEAR(r->top, -limit, 1e-9);
}

TEST(InnerRectangle, NothingForACameraThatCannotBeUsed) {
  EXPECT_FALSE(InnerRectangle({camera::CameraModel::kPinhole, 0, 0, {1.0, 1.0, 0.0, 0.0}}));
  EXPECT_FALSE(InnerRectangle({camera::CameraModel::kPinhole, 10, 10, {}}));
}

TEST(PlacesOfPhotos, PixelsFollowTheHeightAboveGround) {
  TemporaryFolder folder;
  AnalyticSurvey s(folder.path());
  s.AddPhoto(0, 0);
  s.AddPhoto(10, 0);
  s.AddPhoto(20, 0);
  s.survey.photos[1].agl_m = 30.0;                                      // closer: fewer pixels for the same pixel on the ground
  s.survey.photos[2].agl_m = std::numeric_limits<double>::quiet_NaN();  // the median, 60 m of (60, 30), is 45
  const PhotoPlaces places = PlacesOfPhotos(s.input);
  ASSERT_EQ(places.training.size(), 3U);
  EXPECT_NEAR(places.training[0].focal_px, 60.0 / (2.0 * 0.3), 1e-9);
  EXPECT_NEAR(places.training[1].focal_px, 50.0, 1e-9);
  EXPECT_NEAR(places.training[2].focal_px, 75.0, 1e-9);
  EXPECT_EQ(places.training[0].width, 100);
  EXPECT_EQ(places.training[0].height, 75);
}

// Their height says nothing of what they show.
TEST(PlacesOfPhotos, PixelsOfLevelPhotosFollowTheDistanceToTheirPoints) {
  TemporaryFolder folder;
  AnalyticSurvey s(folder.path());
  s.AddPhoto(0, 0);
  s.survey.photos[0].cam_from_enu.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  s.survey.photos[0].cam_from_enu.translation = {0.0, 1.6, 0.0};  // 1.6 m above the ground
  s.survey.photos[0].agl_m = 1.6;
  for (int i = 0; i < 21; ++i) {
    survey::SparsePoint point;
    point.x_in_enu = {0.2 * i, 14.0 + 0.1 * i, 2.0};
    s.survey.points.push_back(point);
    s.survey.tracks.Add({0});
  }
  s.info.gsd_m = 0.1;
  const PhotoPlaces places = PlacesOfPhotos(s.input);
  EXPECT_NEAR(places.training[0].focal_px, 15.0 / (2.0 * 0.1), 1e-6);
  EXPECT_NEAR(places.agl_m, 15.0, 1e-9);
}

TEST(PlacesOfPhotos, NeverFinerThanThePhotoNorTooSmallNorTooLarge) {
  TemporaryFolder folder;
  AnalyticSurvey s(folder.path());
  s.AddPhoto(0, 0);
  s.input.options.view_gsd = 0.01;
  EXPECT_EQ(PlacesOfPhotos(s.input).training[0].width, 200);
  s.input.options.view_gsd = 1000.0;
  EXPECT_EQ(PlacesOfPhotos(s.input).training[0].height, 16);
  s.survey.cameras[0] = PinholeCamera(8000, 6000, 8000.0);
  s.input.options.view_gsd = 1e-4;
  const ViewPose pose = PlacesOfPhotos(s.input).training[0];
  EXPECT_LE(static_cast<double>(pose.width) * pose.height, 4e6);
  EXPECT_GT(static_cast<double>(pose.width) * pose.height, 3.9e6);
}

TEST(PlacesOfPhotos, HeldOutPhotosHaveNone) {
  TemporaryFolder folder;
  AnalyticSurvey s(folder.path());
  s.AddPhoto(0, 0, true);
  s.AddPhoto(10, 0);
  const PhotoPlaces places = PlacesOfPhotos(s.input);
  ASSERT_EQ(places.training.size(), 1U);
  EXPECT_EQ(places.training[0].photo, 1);
  s.survey.photos[0].is_test = false;
  EXPECT_EQ(PlacesOfPhotos(s.input).training.size(), 2U);
}

TEST(PlacesOfPhotos, HeightsOfHeldOutPhotosDoNotStandInForUnknownOnes) {
  TemporaryFolder folder;
  AnalyticSurvey s(folder.path());
  for (const double x : {0.0, 10.0, 20.0, 30.0}) s.AddPhoto(x, 0, x > 15.0);
  s.survey.photos[0].agl_m = std::numeric_limits<double>::quiet_NaN();
  s.survey.photos[1].agl_m = 30.0;
  const PhotoPlaces places = PlacesOfPhotos(s.input);
  ASSERT_EQ(places.training.size(), 2U);
  EXPECT_NEAR(places.training[0].focal_px, 50.0, 1e-9);  // at 30 m, as training photos are, not at the median of all, 60 m
  EXPECT_NEAR(places.agl_m, 30.0, 1e-9);
}

}  // namespace
}  // namespace skyquilt::surface
