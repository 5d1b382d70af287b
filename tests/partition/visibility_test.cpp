#include "partition/visibility.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/partition/flown_survey.h"

namespace skyquilt::partition {
namespace {

const Eigen::Vector3d kLow(-1, -2, -3);
const Eigen::Vector3d kHigh(4, 5, 6);

double Between(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1000001) / 1e6;
}
Eigen::Vector3d Anywhere(double reach) {
  return {Between(-reach, reach), Between(-reach, reach), Between(-reach, reach)};
}

RC_GTEST_PROP(RayMeetsBox, TowardsAPointInside, ()) {
  const Eigen::Vector3d origin = Anywhere(50.0);
  const Eigen::Vector3d target(Between(-0.99, 3.99), Between(-1.99, 4.99), Between(-2.99, 5.99));
  RC_PRE((target - origin).norm() > 1e-3);
  RC_ASSERT(RayMeetsBox(origin, (target - origin).normalized(), kLow, kHigh));
  // Away from it only when it starts inside.
  const bool starts_inside = (origin.array() >= kLow.array()).all() && (origin.array() <= kHigh.array()).all();
  RC_ASSERT(RayMeetsBox(origin, (origin - target).normalized(), kLow, kHigh) == starts_inside);
}

RC_GTEST_PROP(RayMeetsBox, AgreesWithFineMarching, ()) {
  const Eigen::Vector3d origin = Anywhere(15.0);
  const Eigen::Vector3d direction = Anywhere(1.0);
  RC_PRE(direction.norm() > 1e-2);
  const Eigen::Vector3d unit = direction.normalized();
  bool deep_inside = false;
  bool near_box = false;
  for (int i = 0; i <= 6000; ++i) {
    const Eigen::Vector3d x = origin + unit * (0.01 * i);
    deep_inside = deep_inside || ((x - kLow).minCoeff() > 0.01 && (kHigh - x).minCoeff() > 0.01);
    near_box = near_box || ((x - kLow).minCoeff() > -0.02 && (kHigh - x).minCoeff() > -0.02);
  }
  const bool meets = RayMeetsBox(origin, unit, kLow, kHigh);
  RC_ASSERT(!deep_inside || meets);
  RC_ASSERT(near_box || !meets);
}

TEST(RayMeetsBox, AtItsFacesAndBehind) {
  EXPECT_TRUE(RayMeetsBox({-5, -2, 0}, {1, 0, 0}, kLow, kHigh)) << "along a face";
  EXPECT_TRUE(RayMeetsBox({-1, -2, -3}, {0, 0, -1}, kLow, kHigh)) << "from a corner";
  EXPECT_TRUE(RayMeetsBox({0, 0, 0}, {0, 1, 0}, kLow, kHigh)) << "from inside";
  EXPECT_FALSE(RayMeetsBox({-5, -2.0001, 0}, {1, 0, 0}, kLow, kHigh)) << "just beside";
  EXPECT_FALSE(RayMeetsBox({10, 0, 0}, {1, 0, 0}, kLow, kHigh)) << "behind";
  EXPECT_FALSE(RayMeetsBox({std::nan(""), 0, 0}, {1, 0, 0}, kLow, kHigh));
  EXPECT_FALSE(RayMeetsBox({0, 0, 0}, {std::nan(""), 0, 0}, kLow, kHigh));
}

TEST(FindViews, CountsTheShareOfANadirPhoto) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg")};
  // The image spans 114.3 x 85.7 m of the ground; the western half of it.
  const std::vector<Box> boxes = {{{-1000, -1000, -0.001}, {0, 1000, 0}}, {{500, 500, -1}, {600, 600, 0}}, {{-0.4, -0.3, -0.1}, {-0.2, -0.1, 0}}};
  const std::vector<BoxViews> views = FindViews(survey, boxes, 0);
  EXPECT_NEAR(views[0].training_pixels, 240000.0, 1.0);
  EXPECT_TRUE(views[1].photos.empty());
  ASSERT_EQ(views[2].photos.size(), 1U) << "smaller than the gap between rays";
  EXPECT_GE(views[2].training_pixels, 1.0);
  EXPECT_LT(views[2].training_pixels, 10.0);
  EXPECT_NEAR(FindViews(survey, boxes, 400)[0].training_pixels, 60000.0, 1.0);
}

TEST(FindViews, TestPhotosBelongButDoNotCount) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg"), NadirPhoto({1, 0, 100}, "b.jpg")};
  survey.photos[1].is_test = true;
  const BoxViews views = FindViews(survey, {{{-5, -5, -1}, {5, 5, 0}}}, 0).front();
  EXPECT_EQ(views.photos, (std::vector<int>{0, 1}));
  EXPECT_EQ(views.n_training, 1);
}

TEST(FindViews, NotBehindTheCamera) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg")};
  EXPECT_TRUE(FindViews(survey, {{{-5, -5, 150}, {5, 5, 160}}}, 0).front().photos.empty());
}

}  // namespace
}  // namespace skyquilt::partition
