#include "evaluate/photos/choose_photos.h"

#include <gtest/gtest.h>

namespace skyquilt::evaluate::photos {
namespace {

TEST(SelectEvenly, TakesAllOrStandsInTheMiddleOfEqualParts) {
  const std::vector<int> photos = {3, 11, 19, 27, 35, 43};
  EXPECT_EQ(SelectEvenly(photos, 0), photos);
  EXPECT_EQ(SelectEvenly(photos, 6), photos);
  EXPECT_EQ(SelectEvenly(photos, 99), photos);
  EXPECT_EQ(SelectEvenly(photos, 2), (std::vector<int>{11, 35}));
  EXPECT_EQ(SelectEvenly(photos, 1), (std::vector<int>{27}));
  EXPECT_TRUE(SelectEvenly({}, 4).empty());
}

TEST(HeldOutPhotos, AreThoseNeverTrainedOn) {
  survey::Survey survey;
  survey.photos.resize(4);
  survey.photos[1].is_test = survey.photos[3].is_test = true;
  EXPECT_EQ(HeldOutPhotos(survey), (std::vector<int>{1, 3}));
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
