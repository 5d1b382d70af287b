#include "bench/study/data_set.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::bench {
namespace {

namespace fs = std::filesystem;

class DataSetTest : public testing::Test {
 protected:
  fs::path Scene(const std::string& name) const {
    fs::create_directories(folder_ / name);
    return folder_ / name;
  }
  TemporaryFolder folder_;
};

bool Has(const DataSet& set, const std::string& key, const std::string& value) {
  return std::any_of(set.overrides.begin(), set.overrides.end(),
                     [&](const config::Override& entry) { return entry.key == key && entry.value == value; });
}

TEST_F(DataSetTest, BlendersPicturesAreBesideItsFilesAndOverWhite) {
  const fs::path lego = Scene("lego");
  base::WriteFileAtomically(lego / "transforms_train.json", R"({"frames": [{"file_path": "./train/r_0"}]})");
  const DataSet set = FindDataSet(lego, "");
  EXPECT_EQ(set.name, "Blender");
  EXPECT_EQ(set.model, lego);
  EXPECT_EQ(set.pictures, lego);
  EXPECT_TRUE(Has(set, "prepare.alpha", "white"));
}

TEST_F(DataSetTest, MatrixCitysPicturesAreTwoFoldersUp) {
  const fs::path block = Scene("aerial/pose/block_A");
  base::WriteFileAtomically(block / "transforms_train.json", R"({"frames": [{"file_path": "../../train/block_A/0000.png"}]})");
  const DataSet set = FindDataSet(block, "");
  EXPECT_EQ(set.name, "MatrixCity");
  EXPECT_TRUE(fs::equivalent(set.pictures, folder_ / "aerial")) << set.pictures;
  EXPECT_FALSE(Has(set, "prepare.alpha", "white"));
}

TEST_F(DataSetTest, TheReducedPicturesOfTablesAreTaken) {
  const fs::path garden = Scene("garden");
  fs::create_directories(garden / "sparse" / "0");
  EXPECT_THROW(FindDataSet(garden, ""), base::InputError);
  fs::create_directories(garden / "images");
  EXPECT_EQ(FindDataSet(garden, "").pictures, garden / "images");
  fs::create_directories(garden / "images_2");
  EXPECT_EQ(FindDataSet(garden, "").pictures, garden / "images_2");
  fs::create_directories(garden / "images_4");
  EXPECT_EQ(FindDataSet(garden, "").pictures, garden / "images_4");
  EXPECT_EQ(FindDataSet(garden, "images_2").pictures, garden / "images_2");
  EXPECT_EQ(FindDataSet(garden, "").name, "Mip-NeRF 360");
  EXPECT_THROW(FindDataSet(garden, "images_16"), base::InputError);
  base::WriteFileAtomically(garden / "poses_bounds.npy", "");
  EXPECT_EQ(FindDataSet(garden, "").name, "LLFF");
  EXPECT_TRUE(Has(FindDataSet(garden, ""), "prepare.up", "cameras"));
}

TEST_F(DataSetTest, OtherFoldersAreRefused) {
  EXPECT_THROW(FindDataSet(folder_ / "nowhere", ""), base::InputError);
  EXPECT_THROW(FindDataSet(Scene("photos"), ""), base::InputError);
}

}  // namespace
}  // namespace skyquilt::bench
