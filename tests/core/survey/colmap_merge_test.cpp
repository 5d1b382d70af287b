#include "core/survey/colmap_merge.h"

#include <gtest/gtest.h>

#include <fstream>

#include "core/base/file.h"
#include "core/survey/colmap_database.h"
#include "tests/support/error_of.h"
#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::survey {
namespace {

constexpr const char* kPinhole = "(7, 1, 640, 480, x'0000000000407f400000000000407f4000000000000074400000000000006e40', 1)";

class MergeFeaturesTest : public testing::Test {
 protected:
  // A part whose images have the ids n, n - 1, ... 1, as if COLMAP's threads had finished the last one first; feature i of an image tells its name.
  void MakePart(const std::string& file, const std::vector<std::string>& names) {
    test::MadeDatabase made(folder_ / file);
    made.Run(std::string("INSERT INTO cameras VALUES") + kPinhole);
    for (size_t i = 0; i < names.size(); ++i) {
      const auto id = static_cast<uint32_t>(names.size() - i);
      made.AddImage(id, names[i], 7);
      const std::vector<uint8_t> rows(128, static_cast<uint8_t>(names[i][0]));
      made.AddDescriptors(id, rows);
      const std::vector<float> keypoint = {static_cast<float>(names[i][0]), 2.0F};
      made.AddMatrix<float>("keypoints", id, 1, 2, keypoint);
    }
    made.Run("UPDATE images SET prior_tx = 47.5");
  }

  TemporaryFolder folder_;
  std::filesystem::path joined_ = folder_ / "database.db";
};

TEST_F(MergeFeaturesTest, ImagesAreNumberedInTheOrderOfPartsAndNames) {
  MakePart("one.db", {"a.jpg", "b c.jpg"});
  MakePart("two.db", {"d.jpg", "e.jpg", "f.jpg"});
  MakePart("three.db", {"g.jpg"});
  std::ofstream(joined_) << "an earlier file of any content";
  const std::vector<DatabasePart> parts = {{folder_ / "one.db", 1, {"a.jpg", "b c.jpg"}},
                                           {folder_ / "two.db", 1, {"d.jpg", "not there.jpg", "e.jpg", "f.jpg"}},
                                           {folder_ / "three.db", 2, {"g.jpg"}}};
  MergeFeatures(parts, joined_);
  const ColmapDatabase database(joined_);
  const std::vector<DatabaseImage> images = database.ReadImages();
  const std::vector<std::string> names = {"a.jpg", "b c.jpg", "d.jpg", "e.jpg", "f.jpg", "g.jpg"};
  ASSERT_EQ(images.size(), names.size());
  for (uint32_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(images[i].id, i + 1);
    EXPECT_EQ(images[i].name, names[i]);
    EXPECT_EQ(images[i].camera_id, i < 5 ? 1U : 2U);
    EXPECT_EQ(database.ReadDescriptors(i + 1), std::vector<uint8_t>(128, static_cast<uint8_t>(names[i][0])));
    ASSERT_EQ(database.ReadKeypoints(i + 1).size(), 1U);
    EXPECT_EQ(database.ReadKeypoints(i + 1)[0].x, static_cast<float>(names[i][0]));
  }
  const auto cameras = database.ReadCameras();
  ASSERT_EQ(cameras.size(), 2U);
  EXPECT_EQ(cameras.at(1).params, cameras.at(2).params);
  EXPECT_EQ(cameras.at(2).width, 640);
  // Parts stay as they are, for another try.
  EXPECT_EQ(ColmapDatabase(folder_ / "one.db").ReadImages()[0].name, "b c.jpg");
}

TEST_F(MergeFeaturesTest, ADamagedPartIsNamedAndTheEarlierFileStays) {
  MakePart("one.db", {"a.jpg"});
  std::ofstream(folder_ / "two.db") << "no database at all, although it is long enough to have had a head of one. " << std::string(200, 'x');
  std::ofstream(joined_) << "earlier";
  const std::vector<DatabasePart> parts = {{folder_ / "one.db", 1, {"a.jpg"}}, {folder_ / "two.db", 1, {"b.jpg"}}};
  const std::string error = InputErrorOf([&] { MergeFeatures(parts, joined_); });
  EXPECT_NE(error.find("two.db"), std::string::npos) << error;
  EXPECT_NE(error.find("Remove the file"), std::string::npos) << error;
  EXPECT_EQ(base::ReadFile(joined_), "earlier");
  std::filesystem::remove(folder_ / "two.db");
  EXPECT_NE(InputErrorOf([&] { MergeFeatures(parts, joined_); }).find("two.db"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "two.db"));
}

}  // namespace
}  // namespace skyquilt::survey
