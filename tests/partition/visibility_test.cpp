#include "partition/visibility.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "tests/partition/flown_survey.h"

namespace skyquilt::partition {
namespace {

TEST(FindVisibility, CountsTheShareOfANadirPhoto) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg")};
  // The image spans 114.3 x 85.7 m of the ground; the western half of it.
  const std::vector<Box> boxes = {{{-1000, -1000, -0.001}, {0, 1000, 0}}, {{500, 500, -1}, {600, 600, 0}}, {{-0.4, -0.3, -0.1}, {-0.2, -0.1, 0}}};
  const std::vector<BoxVisibility> views = FindVisibility(survey, boxes, 0);
  EXPECT_NEAR(views[0].training_pixels, 240000.0, 1.0);
  EXPECT_TRUE(views[1].photos.empty());
  ASSERT_EQ(views[2].photos.size(), 1U) << "smaller than the gap between rays";
  EXPECT_GE(views[2].training_pixels, 1.0);
  EXPECT_LT(views[2].training_pixels, 10.0);
  EXPECT_NEAR(FindVisibility(survey, boxes, 400)[0].training_pixels, 60000.0, 1.0);
}

TEST(FindVisibility, HeldOutPhotosDoNotCount) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg"), NadirPhoto({1, 0, 100}, "b.jpg")};
  survey.photos[1].is_test = true;
  const std::vector<Box> box = {{{-5, -5, -1}, {5, 5, 0}}};
  const BoxVisibility views = FindVisibility(survey, box, 0).front();
  EXPECT_EQ(views.photos, (std::vector<int>{0}));
  survey.photos.pop_back();
  EXPECT_EQ(views.training_pixels, FindVisibility(survey, box, 0).front().training_pixels);
}

RC_GTEST_PROP(FindVisibilityProperty, NearBoxesAreAllThatAreSeen, ()) {
  survey::Survey survey = FlySurvey({});
  survey.photos.clear();
  const int n_photos = *rc::gen::inRange(1, 6);
  for (int i = 0; i < n_photos; ++i) {
    const double x = *rc::gen::inRange(-400, 400), y = *rc::gen::inRange(-400, 400), z = *rc::gen::inRange(-5, 150);
    survey::Photo photo = NadirPhoto({x, y, z}, std::to_string(i) + ".jpg");
    const double tilt = 0.01 * *rc::gen::inRange(-160, 160);
    const geo::Rigid3d turn{Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX())), Eigen::Vector3d::Zero()};
    photo.cam_from_enu.rotation = turn.rotation * photo.cam_from_enu.rotation;
    photo.cam_from_enu.translation = turn.rotation * photo.cam_from_enu.translation;
    survey.photos.push_back(photo);
  }
  std::vector<Box> boxes;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d low(100.0 * (i % 10) - 500.0, 100.0 * (i / 10) - 500.0, i % 3);
    boxes.push_back({low, low + Eigen::Vector3d(i % 7 == 0 ? 0.5 : 100.0, 100.0, i % 5 == 0 ? 0.0 : 20.0)});
  }
  const std::vector<BoxVisibility> all = FindVisibility(survey, boxes, 0, boxes.size()), near = FindVisibility(survey, boxes, 0, 0);
  for (size_t b = 0; b < boxes.size(); ++b) {
    RC_ASSERT(near[b].photos == all[b].photos);
    RC_ASSERT(near[b].training_pixels == all[b].training_pixels);
  }
}

TEST(FindVisibility, NotBehindTheCamera) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg")};
  EXPECT_TRUE(FindVisibility(survey, {{{-5, -5, 150}, {5, 5, 160}}}, 0).front().photos.empty());
}

}  // namespace
}  // namespace skyquilt::partition
