#include "prepare/poses/focal_check.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sqlite3.h>

#include <limits>

#include "tests/support/made_database.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::poses {
namespace {

camera::Camera CameraWith(double focal_px) {
  return {camera::CameraModel::kPinhole, 800, 600, {focal_px, focal_px, 400.0, 300.0}};
}

// Photos of camera 1, and of camera 2 after them.
survey::ColmapModel ModelWith(double focal_1_px, size_t n_1, double focal_2_px = 571.0, size_t n_2 = 0) {
  survey::ColmapModel model;
  model.cameras = {{1, CameraWith(focal_1_px)}, {2, CameraWith(focal_2_px)}};
  for (size_t i = 0; i < n_1 + n_2; ++i) model.images.push_back({static_cast<uint32_t>(i + 1), i < n_1 ? 1U : 2U, "photo", {}});
  return model;
}

const std::map<uint32_t, camera::Camera> kTagged = {{1, CameraWith(571.0)}, {2, CameraWith(571.0)}};

TEST(FocalCheck, AcceptsWhatTagsMayMean) {
  EXPECT_FALSE(FindFarFocal(ModelWith(571.0, 10), kTagged));
  EXPECT_FALSE(FindFarFocal(ModelWith(0.81 * 571.0, 10), kTagged));
  EXPECT_FALSE(FindFarFocal(ModelWith(1.24 * 571.0, 10), kTagged));
}

TEST(FocalCheck, NamesBothNumbers) {
  const auto far = FindFarFocal(ModelWith(1634.0, 10), kTagged);
  ASSERT_TRUE(far);
  EXPECT_EQ(far->n_photos, 10U);
  EXPECT_EQ(far->Text(), "a focal length of 1634 px for 10 photos, whose tags say 571 px");
  EXPECT_TRUE(FindFarFocal(ModelWith(0.79 * 571.0, 10), kTagged));
  EXPECT_TRUE(FindFarFocal(ModelWith(1.26 * 571.0, 10), kTagged));
  EXPECT_TRUE(FindFarFocal(ModelWith(std::numeric_limits<double>::quiet_NaN(), 10), kTagged));
}

TEST(FocalCheck, ReadsTheFocalLengthOfTheTags) {
  survey::PhotoTags tags;
  EXPECT_FALSE(TaggedFocalPx(tags, 800, 600));
  tags.focal_length_35mm = 0.0;  // written for "no value"
  EXPECT_FALSE(TaggedFocalPx(tags, 800, 600));
  tags.focal_length_35mm = 27.0;
  EXPECT_DOUBLE_EQ(TaggedFocalPx(tags, 800, 600).value(), 600.0);
  EXPECT_DOUBLE_EQ(TaggedFocalPx(tags, 600, 800).value(), 600.0);
  // Measured in pixels of the photo as taken, which was five times as large.
  tags.calibrated_focal_px = 3000.0;
  tags.original_width = 4000;
  tags.original_height = 3000;
  EXPECT_DOUBLE_EQ(TaggedFocalPx(tags, 800, 600).value(), 600.0);
  tags.calibrated_focal_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_DOUBLE_EQ(TaggedFocalPx(tags, 800, 600).value(), 600.0);
}

TEST(FocalCheck, JudgesBySeveralCamerasOfTags) {
  const std::map<uint32_t, double> tagged_px = {{1, 571.0}};
  EXPECT_FALSE(FindFocalFarFrom(tagged_px, ModelWith(571.0, 5, 1634.0, 5)));
  ASSERT_TRUE(FindFocalFarFrom(tagged_px, ModelWith(164.0 / 119.0 * 571.0, 5, 571.0, 5)));
  EXPECT_FALSE(FindFocalFarFrom({}, ModelWith(1634.0, 5)));
}

TEST(FocalCheck, CannotJudgeWithoutTags) {
  EXPECT_TRUE(IsGuessedFocal(CameraWith(960.0)));
  EXPECT_FALSE(IsGuessedFocal(CameraWith(961.0)));
  EXPECT_FALSE(FindFarFocal(ModelWith(1634.0, 10), {{1, CameraWith(960.0)}, {2, CameraWith(571.0)}}));
  EXPECT_FALSE(FindFarFocal(ModelWith(1634.0, 10), {}));
}

// A camera with a few photos says little about the shape of the whole.
TEST(FocalCheck, CountsThePhotosOfAllCameras) {
  EXPECT_FALSE(FindFarFocal(ModelWith(571.0, 9, 1634.0, 1), kTagged));
  const auto far = FindFarFocal(ModelWith(571.0, 8, 300.0, 2), kTagged);
  ASSERT_TRUE(far);
  EXPECT_EQ(far->found_px, 300.0);
  // The camera with the most photos is named.
  const auto both = FindFarFocal(ModelWith(1634.0, 3, 300.0, 7), kTagged);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->found_px, 300.0);
  EXPECT_EQ(both->n_photos, 10U);
}

// A database with photos a, b, c of one camera, for which COLMAP took this focal length.
class CorrectFocalsTest : public ::testing::Test {
 protected:
  void MakeCamera(double focal_px) {
    test::MadeDatabase made(folder_ / "database.db");
    const std::vector<double> params = {focal_px, focal_px, 400.0, 300.0};
    std::string hex;
    for (size_t i = 0; i < params.size() * sizeof(double); ++i) hex += fmt::format("{:02x}", reinterpret_cast<const uint8_t*>(params.data())[i]);
    made.Run("INSERT INTO cameras VALUES(1, 1, 800, 600, x'" + hex + "', 1)");
    uint32_t id = 0;
    for (const char* name : {"a", "b", "c"}) {
      made.AddImage(++id, name);
      input::PhotoFile photo;
      photo.name = name;
      photos_.push_back(photo);
    }
  }
  double Corrected() {
    survey::ColmapDatabase database(folder_ / "database.db");
    CorrectFocals(photos_, database);
    const camera::Camera camera = database.ReadCameras().at(1);
    EXPECT_EQ(camera.FocalX(), camera.FocalY());
    EXPECT_EQ(camera.PrincipalPoint(), Eigen::Vector2d(400.0, 300.0));
    return camera.FocalX();
  }
  bool IsKnown() {
    sqlite3* handle = nullptr;
    sqlite3_stmt* statement = nullptr;
    EXPECT_EQ(sqlite3_open((folder_ / "database.db").c_str(), &handle), SQLITE_OK);
    EXPECT_EQ(sqlite3_prepare_v2(handle, "SELECT prior_focal_length FROM cameras", -1, &statement, nullptr), SQLITE_OK);
    EXPECT_EQ(sqlite3_step(statement), SQLITE_ROW);
    const bool known = sqlite3_column_int(statement, 0) != 0;
    sqlite3_finalize(statement);
    sqlite3_close(handle);
    return known;
  }

  TemporaryFolder folder_;
  std::vector<input::PhotoFile> photos_;
};

TEST_F(CorrectFocalsTest, LeavesLensesAlone) {
  for (const double focal_35mm : {5.1, 24.0, 1499.0}) {
    std::filesystem::remove(folder_ / "database.db");
    MakeCamera(focal_35mm / 35.0 * 800.0);
    EXPECT_EQ(Corrected(), focal_35mm / 35.0 * 800.0);
    EXPECT_TRUE(IsKnown());
  }
}

// FocalLengthIn35mmFilm of 1 mm in all photos.
TEST_F(CorrectFocalsTest, ReplacesWhatNoLensHasByTheGuess) {
  MakeCamera(1.0 / 35.0 * 800.0);
  EXPECT_EQ(Corrected(), 1.2 * 800.0);
  EXPECT_FALSE(IsKnown());
}

TEST_F(CorrectFocalsTest, ReplacesWhatNoLensHasByWhatOtherPhotosSay) {
  MakeCamera(65535.0 / 35.0 * 800.0);
  photos_[1].tags.focal_length_35mm = 24.0;
  photos_[2].tags.focal_length_35mm = 24.0;
  EXPECT_EQ(Corrected(), 24.0 / 35.0 * 800.0);
  EXPECT_TRUE(IsKnown());
}

// COLMAP has guessed: the copies have no tags.
TEST_F(CorrectFocalsTest, PhotosThatWereConvertedKeepTheirTags) {
  MakeCamera(960.0);
  for (input::PhotoFile& photo : photos_) photo.tags.focal_length_35mm = 20.0;
  EXPECT_EQ(Corrected(), 960.0);
  for (input::PhotoFile& photo : photos_) photo.converted = true;
  EXPECT_EQ(Corrected(), 20.0 / 35.0 * 800.0);
  EXPECT_TRUE(IsKnown());
}

}  // namespace
}  // namespace skyquilt::prepare::poses
