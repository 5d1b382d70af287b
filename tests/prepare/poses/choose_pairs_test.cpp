#include "prepare/poses/choose_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/prepare/poses/made_photos.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

// Photos in lines whose features are those of the ground below: each line of cells is `kCellStep_m` to the east, and a photo sees the cells around
// it.
class ChoosePairsTest : public testing::Test {
 protected:
  void MakeSurvey(size_t lines, size_t per_line) {
    photos_ = test::GridPhotos(lines, per_line, 20.0, 40.0, {47.0, 8.0, 400.0});
    base::Random random(1);
    std::vector<std::vector<std::array<uint8_t, 128>>> column(per_line + 2);
    for (auto& features : column) {
      for (int i = 0; i < 40; ++i) features.push_back(test::RandomDescriptor(random));
    }
    test::MadeDatabase made(file_);
    for (size_t i = 0; i < photos_.size(); ++i) {
      // Photos of the same column in all lines see the same: they are alike although their names are far apart.
      std::vector<uint8_t> rows;
      for (size_t c = i % per_line; c < i % per_line + 3; ++c) {
        for (const auto& feature : column[c]) test::AddRow(rows, test::SeenAgain(feature, 6, random));
      }
      const auto id = static_cast<uint32_t>(photos_.size() - i);  // not in the order of the names
      made.AddImage(id, photos_[i].name);
      made.AddDescriptors(id, rows);
    }
  }
  PhotoPairs Choose(const PairRules& rules = {}) {
    std::vector<std::string> names;
    for (const input::PhotoFile& photo : photos_) names.push_back(photo.name);
    FeatureStore features(file_, names, 1 << 20);
    base::ThreadPool threads(2);
    return ChoosePairs(photos_, rules, 1, features, threads);
  }
  size_t CountPairsOf(const PhotoPairs& pairs, uint32_t photo) {
    return static_cast<size_t>(std::count_if(pairs.begin(), pairs.end(), [&](const PhotoPair& pair) { return pair.a == photo || pair.b == photo; }));
  }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "database.db";
  std::vector<input::PhotoFile> photos_;
};

TEST_F(ChoosePairsTest, SmallSurveysHaveAllPairs) {
  MakeSurvey(2, 10);
  EXPECT_EQ(Choose(), AllPairs(20));
}

TEST_F(ChoosePairsTest, TaggedPhotosArePairedInSpace) {
  MakeSurvey(4, 15);
  const PhotoPairs pairs = Choose();
  EXPECT_EQ(pairs, PairsInSpace(FindPlaces(photos_), PairRules{}));
  EXPECT_EQ(CountGroups(photos_.size(), pairs), 1U);
}

TEST_F(ChoosePairsTest, PhotosWithoutTagsArePairedByTheirLooks) {
  MakeSurvey(4, 15);
  constexpr uint32_t kUntagged = 22;  // line 1, column 7
  photos_[kUntagged].tags.gps.reset();
  const PairRules rules{.similar = 6};
  const PhotoPairs pairs = Choose(rules);
  for (const uint32_t same_column : {7U, 37U, 52U}) {
    EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), MakePair(kUntagged, same_column))) << same_column;
  }
  for (const uint32_t by_name : {20U, 21U, 23U, 24U}) {
    EXPECT_TRUE(std::binary_search(pairs.begin(), pairs.end(), MakePair(kUntagged, by_name))) << by_name;
  }
  EXPECT_LE(CountPairsOf(pairs, kUntagged), rules.similar + 2 * rules.name_neighbors);
}

TEST_F(ChoosePairsTest, SurveysWithoutTagsAreConnectedAndMostlyRight) {
  MakeSurvey(4, 15);
  for (input::PhotoFile& photo : photos_) photo.tags.gps.reset();
  const PairRules rules{.similar = 10, .name_neighbors = 0};
  const PhotoPairs pairs = Choose(rules);
  EXPECT_EQ(CountGroups(photos_.size(), pairs), 1U);
  EXPECT_EQ(Choose(rules), pairs);
  const auto n_near = std::count_if(pairs.begin(), pairs.end(), [](const PhotoPair& pair) {
    const auto a = static_cast<int>(pair.a % 15), b = static_cast<int>(pair.b % 15);
    return std::abs(a - b) <= 2;
  });
  EXPECT_GE(n_near * 100, static_cast<ptrdiff_t>(pairs.size()) * 90);
}

// A photo that nothing is like is still connected, by its name or by any pair.
TEST_F(ChoosePairsTest, PhotosWithoutFeaturesAreConnected) {
  MakeSurvey(4, 15);
  photos_[30].tags.gps.reset();
  {
    ASSERT_EQ(sqlite3_initialize(), SQLITE_OK);
    sqlite3* handle = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(handle, "DELETE FROM descriptors WHERE image_id = 30", nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(handle);
  }
  const PhotoPairs pairs = Choose({.name_neighbors = 0});
  EXPECT_EQ(CountGroups(photos_.size(), pairs), 1U);
  EXPECT_GE(CountPairsOf(pairs, 30), 1U);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
