#include "prepare/poses/match_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/prepare/poses/made_photos.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

constexpr uint32_t kPhotos = 8;

// Eight photos of the same sixty features, each in another order. Photo i has the image id kPhotos - i, so that names and ids run the other way.
class MatchPairsTest : public testing::Test {
 protected:
  void SetUp() override {
    base::Random random(3);
    std::vector<std::array<uint8_t, 128>> features;
    for (int i = 0; i < 60; ++i) features.push_back(test::RandomDescriptor(random));
    for (uint32_t photo = 0; photo < kPhotos; ++photo) {
      names_.push_back("photo " + std::to_string(photo) + ".jpg");
      std::vector<uint8_t> rows;
      for (uint32_t i = 0; i < 60; ++i) test::AddRow(rows, test::SeenAgain(features[(i + 7 * photo) % 60], 5, random));
      made_.AddImage(kPhotos - photo, names_.back());
      made_.AddDescriptors(kPhotos - photo, rows);
      rows_.push_back(rows);
    }
  }
  FeatureStore Store(size_t max_bytes = 1 << 20) { return {file_, names_, max_bytes}; }
  size_t CountChunks() const {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(job_.folder), std::filesystem::directory_iterator()));
  }
  // Every feature of a photo matches its own place in the other one's order.
  void ExpectRight(FeatureStore& features, const PhotoPairs& pairs) {
    for (const PhotoPair& pair : pairs) {
      // The smaller id belongs to the later photo.
      const std::vector<survey::FeaturePair> matches = features.database().ReadMatches(kPhotos - pair.a, kPhotos - pair.b);
      ASSERT_EQ(matches.size(), 60U) << pair.a << "-" << pair.b;
      for (const survey::FeaturePair& match : matches) EXPECT_EQ((match[0] + 7 * pair.b) % 60, (match[1] + 7 * pair.a) % 60);
    }
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "database.db";
  test::MadeDatabase made_{file_};
  std::vector<std::string> names_;
  std::vector<std::vector<uint8_t>> rows_;
  MatchJob job_{.folder = folder_ / "matches", .input = "features", .pairs_per_chunk = 5};
  base::ThreadPool threads_{2};
};

TEST_F(MatchPairsTest, FillsTheDatabase) {
  FeatureStore features = Store();
  const PhotoPairs pairs = AllPairs(kPhotos);
  MatchPairs(job_, features, pairs, threads_);
  EXPECT_EQ(CountChunks(), 6U);  // 28 pairs
  EXPECT_EQ(features.database().ReadMatchedPairs(1).size(), pairs.size());
  ExpectRight(features, pairs);
  // Other pairs replace them.
  MatchPairs(job_, features, {{2, 5}}, threads_);
  EXPECT_EQ(features.database().ReadMatchedPairs(0), (std::vector<survey::ImagePair>{{3, 6}}));
  RemoveChunks(job_);
  EXPECT_FALSE(std::filesystem::exists(job_.folder));
}

TEST_F(MatchPairsTest, TooFewMatchesAreNone) {
  FeatureStore features = Store();
  job_.min_matches = 61;
  MatchPairs(job_, features, {{0, 1}}, threads_);
  EXPECT_EQ(features.database().ReadMatchedPairs(0).size(), 1U);
  EXPECT_EQ(features.database().ReadMatchedPairs(1).size(), 0U);
}

// A run that ends in its second chunk: the next one reads the photos of the missing chunks only.
TEST_F(MatchPairsTest, GoesOnAfterTheLastFinishedChunk) {
  const PhotoPairs pairs = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {4, 5}, {4, 6}, {4, 7}, {5, 6}, {5, 7}};
  const std::vector<uint8_t> half(100, 1);
  made_.AddMatrix<uint8_t>("descriptors", kPhotos - 7, 60, 128, half);
  {
    FeatureStore features = Store();
    EXPECT_NE(InputErrorOf([&] { MatchPairs(job_, features, pairs, threads_); }).find("100 bytes"), std::string::npos);
    EXPECT_EQ(CountChunks(), 1U);
    EXPECT_TRUE(features.database().ReadMatchedPairs(0).empty());
  }
  made_.AddDescriptors(kPhotos - 7, rows_[7]);
  FeatureStore features = Store();
  MatchPairs(job_, features, pairs, threads_);
  EXPECT_EQ(features.n_loads(), 4U);
  ExpectRight(features, pairs);
}

TEST_F(MatchPairsTest, StopsWhenAsked) {
  FeatureStore features = Store();
  ExpectStopsWhenAsked([&] { MatchPairs(job_, features, AllPairs(kPhotos), threads_); });
  EXPECT_TRUE(features.database().ReadMatchedPairs(0).empty());
  MatchPairs(job_, features, AllPairs(kPhotos), threads_);
  ExpectRight(features, AllPairs(kPhotos));
}

TEST_F(MatchPairsTest, ChunksOfOtherFeaturesPairsOrRulesAreNotUsed) {
  const PhotoPairs pairs = {{0, 1}, {2, 3}};
  const auto loads = [&](const MatchJob& job, const PhotoPairs& some) {
    FeatureStore features = Store();
    MatchPairs(job, features, some, threads_);
    return features.n_loads();
  };
  EXPECT_EQ(loads(job_, pairs), 4U);
  EXPECT_EQ(loads(job_, pairs), 0U);
  EXPECT_EQ(loads(job_, {{0, 1}, {2, 4}}), 4U);
  MatchJob other = job_;
  other.rules.max_ratio = 0.7;
  EXPECT_EQ(loads(other, {{0, 1}, {2, 4}}), 4U);
  other.input = "other features";
  EXPECT_EQ(loads(other, {{0, 1}, {2, 4}}), 4U);
  EXPECT_EQ(loads(other, {{0, 1}, {2, 4}}), 0U);
}

TEST_F(MatchPairsTest, DamagedChunksAreMatchedAgain) {
  const std::vector<survey::DatabaseMatches> matches = {{{1, 2}, {{3, 4}, {5, 6}}}, {{1, 3}, {}}};
  const std::filesystem::path file = folder_ / "chunk";
  SaveChunk(file, "key", matches);
  const auto loaded = LoadChunk(file, "key");
  ASSERT_TRUE(loaded && loaded->size() == 2U);
  EXPECT_EQ((*loaded)[0].features, matches[0].features);
  EXPECT_EQ((*loaded)[1].images, matches[1].images);
  EXPECT_FALSE(LoadChunk(file, "other"));
  EXPECT_FALSE(LoadChunk(folder_ / "none", "key"));
  const std::string bytes = base::ReadFile(file);
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0x10);
    std::ofstream(file, std::ios::binary) << changed;
    EXPECT_FALSE(LoadChunk(file, "key")) << "byte " << i;
    std::ofstream(file, std::ios::binary) << bytes.substr(0, i);
    EXPECT_FALSE(LoadChunk(file, "key")) << "cut at " << i;
  }
}

TEST_F(MatchPairsTest, AStoreKeepsAsMuchAsAllowed) {
  FeatureStore roomy = Store();
  for (int round = 0; round < 2; ++round) {
    for (uint32_t photo = 0; photo < kPhotos; ++photo) EXPECT_EQ(roomy.Packed(photo)->size(), 60U);
  }
  EXPECT_EQ(roomy.n_loads(), 8U);
  // 64 rows of 132 bytes with the offsets: room for two.
  FeatureStore two = Store(2 * 64 * 132);
  two.Packed(0);
  const auto held = two.Packed(1);
  two.Packed(0);
  two.Packed(2);  // 1 goes
  two.Packed(0);
  EXPECT_EQ(two.n_loads(), 3U);
  two.Packed(1);
  EXPECT_EQ(two.n_loads(), 4U);
  EXPECT_EQ(held->size(), 60U);
  FeatureStore none = Store(0);
  none.Packed(5);
  none.Packed(5);
  EXPECT_EQ(none.n_loads(), 1U);
  none.Packed(6);
  none.Packed(5);
  EXPECT_EQ(none.n_loads(), 3U);
}

TEST_F(MatchPairsTest, TheStoreGivesLargeFeaturesFirst) {
  std::vector<float> keypoints;
  for (int i = 0; i < 60; ++i) keypoints.insert(keypoints.end(), {1.0F, 2.0F, static_cast<float>((i * 37) % 60 + 1), 0.0F});
  made_.AddMatrix<float>("keypoints", kPhotos, 60, 4, keypoints);
  FeatureStore features = Store();
  const std::vector<uint8_t> sorted = features.LargestFirst(0);
  ASSERT_EQ(sorted.size(), rows_[0].size());
  for (size_t i = 0; i < 60; ++i) {
    const auto rank = static_cast<ptrdiff_t>(59 - (i * 37) % 60);
    EXPECT_TRUE(std::equal(sorted.begin() + rank * 128, sorted.begin() + rank * 128 + 128, rows_[0].begin() + static_cast<ptrdiff_t>(i * 128))) << i;
  }
  // Without radii: as they are.
  EXPECT_EQ(features.LargestFirst(1), rows_[1]);
  names_.push_back("stranger.jpg");
  EXPECT_NE(InputErrorOf([&] { Store(); }).find("stranger.jpg"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
