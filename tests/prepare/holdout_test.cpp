#include "prepare/holdout.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/prepare/synthetic_flight.h"

namespace skyquilt::prepare {
namespace {

survey::Survey Photos(int n) {
  survey::Survey survey;
  for (int i = 0; i < n; ++i) {
    survey::Photo photo;
    photo.name = "p" + std::to_string(i) + ".jpg";
    survey.photos.push_back(photo);
  }
  survey.unregistered = {"lost.jpg"};
  return survey;
}

std::vector<int> TestIndices(const std::string& holdout, int n) {
  survey::Survey survey = Photos(n);
  MarkHoldout(ParseHoldout(holdout), survey);
  std::vector<int> indices;
  for (int i = 0; i < n; ++i) {
    if (survey.photos[static_cast<size_t>(i)].is_test) indices.push_back(i);
  }
  return indices;
}

TEST(Holdout, CountsRegisteredPhotosInNameOrder) {
  EXPECT_EQ(TestIndices("every:8", 18), (std::vector<int>{0, 8, 16}));
  EXPECT_EQ(TestIndices("every:5:3", 10), (std::vector<int>{3, 8}));
  EXPECT_EQ(TestIndices("none", 4), (std::vector<int>{}));
  EXPECT_EQ(TestIndices("every:8", 0), (std::vector<int>{}));
}

TEST(Holdout, NonsenseIsAUsageError) {
  for (const char* text :
       {"", "every", "every:", "every:0", "every:1", "every:-8", "every:8:8", "every:8:-1", "every:8x", "every:8:", "list:", "some", "none "}) {
    EXPECT_THROW(ParseHoldout(text), base::UsageError) << text;
  }
}

TEST(Holdout, AListNamesPhotos) {
  const TemporaryFolder folder;
  base::WriteFileAtomically(folder / "list.txt", "# comment\n\n p1.jpg \r\nlost.jpg\np3.jpg");
  EXPECT_EQ(TestIndices("list:" + (folder / "list.txt").string(), 5), (std::vector<int>{1, 3}));
  base::WriteFileAtomically(folder / "list.txt", "p1.jpg\nnever_seen.jpg\n");
  EXPECT_THROW(TestIndices("list:" + (folder / "list.txt").string(), 5), base::InputError);
  EXPECT_THROW(TestIndices("list:" + (folder / "absent.txt").string(), 5), base::InputError);
}

TEST(Holdout, SomethingMustRemainToTrainOn) {
  EXPECT_THROW(TestIndices("every:2", 1), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::prepare
