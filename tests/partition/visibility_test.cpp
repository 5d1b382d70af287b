#include "partition/visibility.h"

#include <gtest/gtest.h>

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

TEST(FindVisibility, NotBehindTheCamera) {
  survey::Survey survey = FlySurvey({});
  survey.photos = {NadirPhoto({0, 0, 100}, "a.jpg")};
  EXPECT_TRUE(FindVisibility(survey, {{{-5, -5, 150}, {5, 5, 160}}}, 0).front().photos.empty());
}

}  // namespace
}  // namespace skyquilt::partition
