#include "evaluate/photos/choose_photos.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

namespace skyquilt::evaluate::photos {
namespace {

RC_GTEST_PROP(SpreadOrderProperty, HasEveryPhotoOnceAndItsBeginningIsSpread, ()) {
  const int n = *rc::gen::inRange(0, 300);
  std::vector<int> photos(static_cast<size_t>(n));
  std::iota(photos.begin(), photos.end(), 5);
  const std::vector<int> order = SpreadOrder(photos);
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  RC_ASSERT(sorted == photos);
  if (n < 8) return;
  // Of the first eight, two at least in each third.
  std::vector<int> thirds(3);
  for (size_t i = 0; i < 8; ++i) ++thirds[static_cast<size_t>(3 * (order[i] - 5) / n)];
  for (const int in_third : thirds) RC_ASSERT(in_third >= 2);
}

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
