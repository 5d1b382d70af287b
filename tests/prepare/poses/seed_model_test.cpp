#include "prepare/poses/seed_model.h"

#include <gtest/gtest.h>

#include <array>
#include <map>

#include "core/survey/colmap_model.h"
#include "tests/prepare/poses/fake_colmap.h"
#include "tests/prepare/poses/seed/made_survey.h"
#include "tests/support/made_database.h"

namespace skyquilt::prepare::poses {
namespace {

void AddCamera(test::MadeDatabase& database, int id, const camera::Camera& camera) {
  std::string hex;
  for (const double parameter : camera.params) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(&parameter);
    for (size_t k = 0; k < sizeof(parameter); ++k) hex += fmt::format("{:02x}", bytes[k]);
  }
  database.Run(
      fmt::format("INSERT INTO cameras VALUES({}, {}, {}, {}, x'{}', 1)", id, static_cast<int>(camera.model), camera.width, camera.height, hex));
}

// COLMAP finds the features of a made flight, and the mapper would find all poses.
class SeededWay : public test::FakeColmap {
 protected:
  void SetUp() override {
    FakeColmap::SetUp();
    photos_.clear();
    made_ = test::MakeSurvey({.strips = 3, .per_strip = 4, .points_per_photo = 200, .seed = 5});
    WriteProgram(test::kFastProgram);
    SetNumber("first", 12);
    SetNumber("focal", static_cast<size_t>(made_.input.cameras.at(1).camera.FocalX()));
    test::MadeDatabase database(folder_ / "made.db");
    database.Run("PRAGMA journal_mode = DELETE");
    AddCamera(database, 1, made_.input.cameras.at(1).camera);
    base::Random random(3);
    std::map<int, std::array<uint8_t, 128>> look;
    for (size_t i = 0; i < made_.input.photos.size(); ++i) {
      const SeedPhoto& photo = made_.input.photos[i];
      base::WriteFileAtomically(folder_ / ("images/" + photo.name), "pixels");
      input::PhotoFile file{.name = photo.name, .width = 1600, .height = 1200, .tags = {}};
      file.tags.gps = photo.gps;
      file.tags.gimbal_yaw_deg = photo.yaw_deg;
      file.tags.gimbal_pitch_deg = photo.pitch_deg;
      file.tags.gimbal_roll_deg = photo.roll_deg;
      photos_.push_back(file);
      std::vector<uint8_t> rows;
      std::vector<float> places;
      for (size_t k = 0; k < photo.features.size(); ++k) {
        const auto [at, is_new] = look.try_emplace(made_.points[i][k]);
        if (is_new) at->second = test::RandomDescriptor(random);
        test::AddRow(rows, test::SeenAgain(at->second, 4, random));
        places.insert(places.end(), {photo.features[k].x(), photo.features[k].y()});
      }
      database.AddImage(photo.image_id, photo.name);
      database.AddDescriptors(photo.image_id, rows);
      database.AddMatrix<float>("keypoints", photo.image_id, static_cast<int64_t>(places.size() / 2), 2, places);
    }
  }
  std::string Seeded() const { return (job_.folder / "seeded").string(); }

  test::MadeSurvey made_;
};

// All photos have few features, so they are searched twice.
constexpr const char* kWithoutMapper = "feature_extractor\nfeature_extractor\nmatches_importer\n";
constexpr const char* kWithMapper = "feature_extractor\nfeature_extractor\nmatches_importer\nmapper\n";

TEST_F(SeededWay, NeedsNoMapper) {
  EXPECT_EQ(Find(), Seeded());
  EXPECT_EQ(Calls(), kWithoutMapper);
  const survey::ColmapModel model = survey::ReadColmapModel(Seeded());
  ASSERT_EQ(model.images.size(), 12U);
  EXPECT_GT(model.points.size(), 200U);
  // Distances between cameras are those of the flight, to within what the tags know of its scale.
  const auto centre = [&](size_t i) { return model.images[i].cam_from_world.OriginInSource(); };
  for (size_t i = 1; i < 12; ++i) {
    const double truth = (made_.cam_from_enu[i].OriginInSource() - made_.cam_from_enu[0].OriginInSource()).norm();
    EXPECT_NEAR((centre(i) - centre(0)).norm(), truth, 0.05 * truth + 0.2) << model.images[i].name;
  }
  EXPECT_EQ(Find(), Seeded());
  EXPECT_EQ(Calls(), "");
}

TEST_F(SeededWay, GoesOnAfterAKill) {
  Find();
  Calls();
  const std::string points = base::ReadFile(job_.folder / "seeded" / "points3D.bin");
  // Killed before the step was marked as done, with half of the model written.
  std::filesystem::remove(job_.folder / "seeded.done");
  std::filesystem::remove(job_.folder / "seeded" / "points3D.bin");
  EXPECT_EQ(Find(), Seeded());
  EXPECT_EQ(Calls(), "");
  EXPECT_EQ(base::ReadFile(job_.folder / "seeded" / "points3D.bin"), points);
}

TEST_F(SeededWay, OtherTagsAreTriedAnew) {
  Find();
  Calls();
  // Neither features nor the choice of pairs depend on the roll.
  for (input::PhotoFile& photo : photos_) *photo.tags.gimbal_roll_deg += 1.0;
  const auto before = std::filesystem::last_write_time(job_.folder / "seeded" / "images.bin");
  EXPECT_EQ(Find(), Seeded());
  EXPECT_EQ(Calls(), "");
  EXPECT_NE(std::filesystem::last_write_time(job_.folder / "seeded" / "images.bin"), before);
}

TEST_F(SeededWay, WrongTagsLeaveItToTheMapper) {
  for (size_t i = 0; i < photos_.size(); ++i) photos_[i].tags.gps = made_.input.photos[(5 * i + 7) % 12].gps;
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), kWithMapper);
  EXPECT_FALSE(std::filesystem::exists(Seeded()));
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), "");
}

// Right tags after wrong ones, and the other way round: no model of the other tags is left over.
TEST_F(SeededWay, FollowsTheTags) {
  const std::vector<input::PhotoFile> right = photos_;
  for (input::PhotoFile& photo : photos_) photo.tags.gps.reset();
  EXPECT_EQ(Find(), FirstModel());
  photos_ = right;
  EXPECT_EQ(Find(), Seeded());
  for (input::PhotoFile& photo : photos_) photo.tags.gps.reset();
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_FALSE(std::filesystem::exists(Seeded()));
}

TEST_F(SeededWay, IsNotTriedWhenNotWanted) {
  options_.seed_poses = false;
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), kWithMapper);
  // A finished model is not replaced.
  options_.seed_poses = true;
  EXPECT_EQ(Find(), FirstModel());
  EXPECT_EQ(Calls(), "");
}

TEST_F(SeededWay, ADatabaseWithoutPlacesOfFeaturesIsLeftToTheMapper) {
  Find();
  std::string reason;
  EXPECT_TRUE(ReadSeedInput(job_.Database(), photos_, &reason));
  { const test::MadeDatabase empty(job_.Database().string() + ".other"); }
  EXPECT_TRUE(ReadSeedInput(job_.Database().string() + ".other", photos_, &reason)->photos.empty());
  sqlite3* handle = nullptr;
  ASSERT_EQ(sqlite3_open(job_.Database().c_str(), &handle), SQLITE_OK);
  ASSERT_EQ(sqlite3_exec(handle, "DELETE FROM keypoints WHERE image_id = 4", nullptr, nullptr, nullptr), SQLITE_OK);
  sqlite3_close(handle);
  EXPECT_FALSE(ReadSeedInput(job_.Database(), photos_, &reason));
  EXPECT_NE(reason.find("no places for the matched features"), std::string::npos) << reason;
}

TEST(SeedInput, TellsGuessedFocalLengthsAndTagsApart) {
  const geo::EnuFrame frame({47.0, 8.0, 400.0});
  const std::vector<input::PhotoFile> photos = {test::PhotoAt(0, {0.0, 0.0}, frame), test::PhotoAt(1, {9.0, 0.0}, frame)};
  std::vector<input::PhotoFile> other = photos;
  EXPECT_EQ(SeedInputs(photos), SeedInputs(other));
  other[1].tags.gps->height_m += 0.01;
  EXPECT_NE(SeedInputs(photos), SeedInputs(other));
  other = photos;
  // Yaw, pitch and place change the pairs already.
  other[1].tags.gimbal_roll_deg = 3.0;
  EXPECT_NE(SeedInputs(photos), SeedInputs(other));

  const TemporaryFolder folder;
  {
    test::MadeDatabase database(folder / "a.db");
    database.AddImage(1, photos[0].name, 1);
    database.AddImage(2, photos[1].name, 2);
    // 1.2 times the longer side, and another number.
    AddCamera(database, 1, {camera::CameraModel::kSimplePinhole, 64, 48, {1.2 * 64.0, 32.0, 24.0}});
    AddCamera(database, 2, {camera::CameraModel::kSimplePinhole, 64, 48, {60.0, 32.0, 24.0}});
  }
  std::string reason;
  const auto input = ReadSeedInput(folder / "a.db", photos, &reason);
  ASSERT_TRUE(input) << reason;
  EXPECT_FALSE(input->cameras.at(1).focal_is_known);
  EXPECT_TRUE(input->cameras.at(2).focal_is_known);
}

}  // namespace
}  // namespace skyquilt::prepare::poses
