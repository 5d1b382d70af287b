#include "core/survey/colmap_database.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::survey {
namespace {

using test::MadeDatabase;

void Replace(ColmapDatabase& database, std::vector<DatabaseMatches> all) {
  size_t next = 0;
  database.ReplaceMatches([&](DatabaseMatches& matches) {
    if (next == all.size()) return false;
    matches = all[next++];
    return true;
  });
}

class Database : public testing::Test {
 protected:
  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_ / "database.db";
  MadeDatabase made_{file_};
};

TEST_F(Database, PairIdsAreColmaps) {
  EXPECT_EQ(PairId(1, 2), 2147483649U);
  EXPECT_EQ(PairId(2, 1), 2147483649U);
  EXPECT_EQ(ImagesOfPair(2147483649U), (ImagePair{1, 2}));
  const auto largest = static_cast<uint32_t>(kMaxDatabaseId - 1);
  EXPECT_EQ(ImagesOfPair(PairId(largest, largest - 1)), (ImagePair{largest - 1, largest}));
  EXPECT_THROW(PairId(3, 3), std::logic_error);
}

TEST_F(Database, ImagesCamerasAndFeaturesAreRead) {
  const std::vector<double> params = {500.0, 510.0, 320.0, 240.0, 0.1, 0.2, 0.3, 0.4};
  made_.Run("INSERT INTO cameras VALUES(1, 4, 640, 480, x'00', 0)");
  made_.AddImage(2, "b with space.jpg");
  made_.AddImage(1, "a.jpg");
  EXPECT_NE(InputErrorOf([&] { ColmapDatabase(file_).ReadCameras(); }).find("1 bytes of parameters"), std::string::npos);
  made_.Run(
      "DELETE FROM cameras; INSERT INTO cameras VALUES(1, 1, 640, 480, x'0000000000407f400000000000407f4000000000000074400000000000006e40', 0)");
  const std::vector<float> similar = {10.5F, 20.5F, 0.0F, -3.0F, 3.0F, 0.0F};
  made_.AddMatrix<float>("keypoints", 1, 1, 6, similar);
  const std::vector<float> four = {1.0F, 2.0F, 5.0F, 0.5F, 3.0F, 4.0F, 6.0F, -0.5F};
  made_.AddMatrix<float>("keypoints", 2, 2, 4, four);
  std::vector<uint8_t> rows(256);
  for (size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<uint8_t>(i);
  made_.AddDescriptors(1, rows);

  const ColmapDatabase database(file_);
  const std::vector<DatabaseImage> images = database.ReadImages();
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[0].name, "a.jpg");
  EXPECT_EQ(images[1].id, 2U);
  EXPECT_EQ(images[1].name, "b with space.jpg");
  const auto cameras = database.ReadCameras();
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras.at(1).params, (std::vector<double>{500.0, 500.0, 320.0, 240.0}));
  EXPECT_EQ(cameras.at(1).height, 480);
  const std::vector<DatabaseKeypoint> first = database.ReadKeypoints(1), second = database.ReadKeypoints(2);
  ASSERT_EQ(first.size(), 1U);
  EXPECT_FLOAT_EQ(first[0].y, 20.5F);
  EXPECT_FLOAT_EQ(first[0].scale, 3.0F);
  ASSERT_EQ(second.size(), 2U);
  EXPECT_FLOAT_EQ(second[1].scale, 6.0F);
  EXPECT_EQ(database.ReadDescriptors(1), rows);
  EXPECT_EQ(database.CountDescriptors(1), 2U);
  EXPECT_TRUE(database.ReadDescriptors(2).empty());
  EXPECT_TRUE(database.ReadKeypoints(7).empty());
}

TEST_F(Database, FeaturesOfTheGivenImagesAreRemoved) {
  const std::vector<float> place = {1.0F, 2.0F};
  for (const uint32_t id : {1U, 2U, 3U}) {
    made_.AddImage(id, std::to_string(id) + ".jpg");
    made_.AddMatrix<float>("keypoints", id, 1, 2, place);
    made_.AddDescriptors(id, std::vector<uint8_t>(128, static_cast<uint8_t>(id)));
  }
  ColmapDatabase database(file_);
  database.RemoveFeatures(std::vector<uint32_t>{1, 3, 8});
  EXPECT_EQ(database.ReadImages().size(), 3U);
  EXPECT_EQ(database.CountDescriptors(1) + database.CountDescriptors(3), 0U);
  EXPECT_TRUE(database.ReadKeypoints(1).empty());
  EXPECT_EQ(database.ReadKeypoints(2).size(), 1U);
  EXPECT_EQ(database.ReadDescriptors(2), std::vector<uint8_t>(128, 2));
}

TEST_F(Database, MatchesComeBackAsWritten) {
  ColmapDatabase database(file_);
  const std::vector<FeaturePair> features = {{0, 7}, {4294967295U, 1}};
  Replace(database, {{{1, 2}, features}, {{2, 9}, {}}});
  EXPECT_EQ(database.ReadMatches(2, 1), features);
  EXPECT_TRUE(database.ReadMatches(2, 9).empty());
  EXPECT_TRUE(database.ReadMatches(1, 9).empty());
  EXPECT_EQ(database.ReadMatchedPairs(0), (std::vector<ImagePair>{{1, 2}, {2, 9}}));
  EXPECT_EQ(database.ReadMatchedPairs(1), (std::vector<ImagePair>{{1, 2}}));

  // Geometries of earlier matches would keep COLMAP from making new ones.
  const std::vector<uint32_t> inliers = {0, 7};
  made_.AddMatrix<uint32_t>("two_view_geometries", PairId(1, 2), 1, 2, inliers);
  made_.AddMatrix<uint32_t>("two_view_geometries", PairId(1, 3), 0, 0, std::span<const uint32_t>());
  const std::vector<DatabaseMatches> verified = database.ReadTwoViewMatches();
  ASSERT_EQ(verified.size(), 2U);
  EXPECT_EQ(verified[0].images, (ImagePair{1, 2}));
  EXPECT_EQ(verified[0].features, (std::vector<FeaturePair>{{0, 7}}));
  EXPECT_TRUE(verified[1].features.empty());
  Replace(database, {{{1, 3}, features}});
  EXPECT_EQ(database.CountTwoViewGeometries(0), 0U);
  EXPECT_EQ(database.ReadMatchedPairs(0), (std::vector<ImagePair>{{1, 3}}));
}

TEST_F(Database, AFailureWhileWritingLeavesTheOldMatches) {
  ColmapDatabase database(file_);
  Replace(database, {{{1, 2}, {{3, 4}}}});
  size_t n_given = 0;
  EXPECT_THROW(database.ReplaceMatches([&](DatabaseMatches& matches) {
    if (++n_given == 3) throw base::Interrupted();
    matches = {{5, static_cast<uint32_t>(5 + n_given)}, {{1, 1}}};
    return true;
  }),
               base::Interrupted);
  EXPECT_EQ(database.ReadMatchedPairs(0), (std::vector<ImagePair>{{1, 2}}));
  EXPECT_EQ(ColmapDatabase(file_).ReadMatches(1, 2), (std::vector<FeaturePair>{{3, 4}}));
}

TEST_F(Database, PlainNamesLastUntilTheNextOpening) {
  made_.AddImage(1, "flight 1/a b.jpg");
  made_.AddImage(2, "image_1");
  ColmapDatabase database(file_);
  database.UsePlainNames();
  EXPECT_EQ(database.ReadImages()[0].name, ColmapDatabase::PlainName(1));
  EXPECT_EQ(database.ReadImages()[1].name, ColmapDatabase::PlainName(2));
  database.UsePlainNames();  // as after a kill between the two
  const ColmapDatabase again(file_);
  EXPECT_EQ(again.ReadImages()[0].name, "flight 1/a b.jpg");
  EXPECT_EQ(again.ReadImages()[1].name, "image_1");
  EXPECT_EQ(database.ReadImages()[0].name, "flight 1/a b.jpg");
}

TEST_F(Database, BlobsOfAWrongSizeAreRefused) {
  const std::vector<uint8_t> bytes(260, 1);
  const std::vector<uint32_t> numbers(6, 1);
  const std::vector<float> places(12, 1.0F);
  const auto refused = [&](const std::string& what, const auto& read) {
    const std::string error = InputErrorOf([&] { read(ColmapDatabase(file_)); });
    EXPECT_NE(error.find(file_.string()), std::string::npos) << what << ": " << error;
    EXPECT_NE(error.find(what), std::string::npos) << error;
  };
  const auto descriptors = [](const ColmapDatabase& database) { database.ReadDescriptors(1); };
  for (const int64_t rows : {int64_t{3}, int64_t{-2}, std::numeric_limits<int64_t>::max(), int64_t{1} << 57, int64_t{0}}) {
    made_.AddMatrix<uint8_t>("descriptors", 1, rows, 128, std::span(bytes).first(256));
    refused("descriptors of image 1", descriptors);
  }
  made_.AddMatrix<uint8_t>("descriptors", 1, 2, 128, bytes);
  refused("260 bytes", descriptors);
  made_.AddMatrix<uint8_t>("descriptors", 1, 4, 64, std::span(bytes).first(256));
  refused("64 columns", descriptors);
  made_.AddMatrix<float>("keypoints", 1, 4, 3, places);
  refused("3 columns", [](const ColmapDatabase& database) { database.ReadKeypoints(1); });
  std::vector<float> not_finite = places;
  not_finite[4] = std::numeric_limits<float>::quiet_NaN();
  made_.AddMatrix<float>("keypoints", 1, 2, 6, not_finite);
  refused("not numbers", [](const ColmapDatabase& database) { database.ReadKeypoints(1); });
  made_.AddMatrix<uint32_t>("matches", PairId(1, 2), 2, 3, numbers);
  refused("matches of images 1 and 2", [](const ColmapDatabase& database) { database.ReadMatches(1, 2); });
  made_.AddMatrix<uint32_t>("two_view_geometries", 5 * kMaxDatabaseId + 3, 3, 2, numbers);
  refused("pair 10737418238", [](const ColmapDatabase& database) { database.ReadTwoViewMatches(); });
}

TEST_F(Database, FilesThatAreNoDatabaseAreRefused) {
  EXPECT_NE(InputErrorOf([&] { ColmapDatabase(folder_ / "none.db"); }).find("no such file"), std::string::npos);
  base::WriteFileAtomically(folder_ / "text.db", std::string(5000, 'x'));
  EXPECT_NE(InputErrorOf([&] { ColmapDatabase(folder_ / "text.db"); }).find("text.db"), std::string::npos);
  base::WriteFileAtomically(folder_ / "empty.db", "");
  EXPECT_NE(InputErrorOf([&] { ColmapDatabase(folder_ / "empty.db").ReadImages(); }).find("no such table"), std::string::npos);
  made_.Run("DROP TABLE matches");
  ColmapDatabase database(file_);
  EXPECT_NE(InputErrorOf([&] { database.ReadMatches(1, 2); }).find("no such table: matches"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { Replace(database, {}); }).find("no such table: matches"), std::string::npos);
  made_.Run("INSERT INTO cameras VALUES(1, 99, 640, 480, x'00', 0)");
  EXPECT_NE(InputErrorOf([&] { database.ReadCameras(); }).find("number 99"), std::string::npos);
}

// A half-copied file: its pages are missing.
TEST(DatabaseFile, ACutOffFileIsRefused) {
  const TemporaryFolder folder;
  {
    MadeDatabase made(folder / "whole.db");
    for (uint32_t id = 1; id < 40; ++id) made.AddDescriptors(id, std::vector<uint8_t>(128 * 64, 3));
  }
  const std::string bytes = base::ReadFile(folder / "whole.db");
  base::WriteFileAtomically(folder / "cut.db", bytes.substr(0, bytes.size() / 2));
  EXPECT_THROW(
      {
        const ColmapDatabase database(folder / "cut.db");
        for (uint32_t id = 1; id < 40; ++id) EXPECT_EQ(database.ReadDescriptors(id).size(), 128U * 64U);
      },
      base::InputError);
}

}  // namespace
}  // namespace skyquilt::survey
