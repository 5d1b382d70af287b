// The field's own data sets: every ray as the set's documentation gives it (made_sets.h), the published split, and the pictures that are its own.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/list_files.h"
#include "prepare/input/match_sizes.h"
#include "prepare/model_use.h"
#include "prepare/models/read_model.h"
#include "prepare/prepare.h"
#include "tests/prepare/models/made_sets.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare {
namespace {

namespace fs = std::filesystem;

class DataSets : public ::testing::Test {
 protected:
  // As Prepare does.
  models::InputModel Read(const test::MadeSet& set) {
    const input::InputFolder folders = input::FindInputs(set.photo_root, set.model, "");
    std::vector<input::InputFile> files = input::ListInput(folders.photo_root, {}, threads_);
    models::InputModel model = models::ReadModel(folders.model, models::ModelPhotos(folders.photo_root, input::TakenNames(files)));
    LeaveOutUnnamed(model, files);
    taken_ = input::TakenNames(files);
    std::vector<input::PhotoFile> photos;
    for (const std::string& name : taken_) {
      input::PhotoFile photo{.name = name};
      image::ReadImageSize(folders.photo_root / name, &photo.width, &photo.height);
      photos.push_back(photo);
    }
    input::ScaleToPhotos(input::FindPhotos(model.sfm, photos), photos, folders.model, model.format == models::ModelFormat::kColmap,
                         folder_ / "scaled", model.sfm);
    return model;
  }

  void ExpectRays(const models::InputModel& model, const test::MadeSet& set) {
    ASSERT_EQ(model.sfm.images.size(), set.names.size());
    for (const survey::ColmapImage& image : model.sfm.images) {
      ASSERT_TRUE(std::find(set.names.begin(), set.names.end(), image.name) != set.names.end()) << image.name;
      const camera::Camera& camera = model.sfm.cameras.at(image.camera_id);
      ASSERT_EQ(camera.width, test::kSetWidth);
      ASSERT_EQ(camera.height, test::kSetHeight);
      for (const auto& [i, j] : {std::pair{0, 0}, {39, 0}, {0, 29}, {39, 29}, {20, 15}, {7, 22}}) {
        const test::SetRay expected = set.ray(image.name, i, j);
        const Eigen::Vector3d direction = image.cam_from_world.rotation.conjugate() * camera.RayFromImg({i + 0.5, j + 0.5});
        EXPECT_LT((image.cam_from_world.OriginInSource() - expected.origin).norm(), 1e-9) << image.name;
        EXPECT_LT((direction - expected.direction).norm(), 1e-9) << image.name << " " << i << " " << j;
      }
    }
  }
  static std::set<std::string> Set(const std::vector<std::string>& names) { return {names.begin(), names.end()}; }

  TemporaryFolder folder_;
  base::ThreadPool threads_{1};
  std::vector<std::string> taken_;  // photos that are left
};

TEST_F(DataSets, Blender) {
  const test::MadeSet set = test::MakeBlender(folder_.path());
  const models::InputModel model = Read(set);
  EXPECT_EQ(model.set, "Blender");
  ExpectRays(model, set);
  EXPECT_EQ(model.test_photos, Set(set.test));
  EXPECT_EQ(taken_, set.names);  // neither val nor depths
  ASSERT_TRUE(model.up.has_value());
  EXPECT_EQ(*model.up, Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(model.metres_per_unit.has_value());
}

// Without test, val is what there is to score.
TEST_F(DataSets, BlenderHoldsOutValWhereThereIsNoTest) {
  const test::MadeSet set = test::MakeBlender(folder_.path());
  fs::remove(folder_ / "transforms_test.json");
  EXPECT_EQ(Read(set).test_photos, (std::set<std::string>{"val/r_0.png", "val/r_1.png"}));
}

TEST_F(DataSets, TheTrainFileStandsForItsSplit) {
  test::MadeSet set = test::MakeBlender(folder_.path());
  set.model = folder_ / "transforms_train.json";
  EXPECT_EQ(Read(set).test_photos, Set(set.test));
}

TEST_F(DataSets, Llff) {
  const test::MadeSet set = test::MakeLlff(folder_.path());
  const models::InputModel model = Read(set);
  EXPECT_EQ(model.format, models::ModelFormat::kPosesBounds);
  ExpectRays(model, set);
  EXPECT_EQ(model.test_photos, Set(set.test));
  EXPECT_EQ(model.test_photos.size(), 3U);
  EXPECT_TRUE(model.sfm.points.empty());
}

// The points of the model that the poses were made from, with the photos that saw them; not those of another model.
TEST_F(DataSets, LlffHasThePointsOfItsSparseModel) {
  const test::MadeSet set = test::MakeLlff(folder_.path());
  const test::MadeSet colmap = test::MakeMip360(folder_ / "colmap");
  fs::rename(folder_ / "colmap" / "sparse", folder_ / "sparse");
  const models::InputModel model = Read(set);
  ExpectRays(model, set);
  ASSERT_EQ(model.sfm.points.size(), 5U);
  EXPECT_EQ(model.sfm.points[1].x_in_world, Eigen::Vector3d(0.1, 0.2, -0.1));
  // COLMAP's ids are 100 - i there, ours count from 1.
  EXPECT_EQ(model.sfm.points[1].image_ids, (std::vector<uint32_t>{1U, 2U}));
  survey::ColmapModel moved = survey::ReadColmapModel(folder_ / "sparse" / "0");
  moved.images[3].cam_from_world.translation.x() += 1.0;
  fs::remove_all(folder_ / "sparse");
  survey::WriteColmapText(moved, folder_ / "sparse" / "0");
  EXPECT_TRUE(Read(set).sfm.points.empty());
}

TEST_F(DataSets, MipNerf360) {
  const test::MadeSet set = test::MakeMip360(folder_.path());
  const models::InputModel model = Read(set);
  EXPECT_EQ(model.format, models::ModelFormat::kColmap);
  ExpectRays(model, set);
  EXPECT_EQ(model.test_photos, Set(set.test));
  EXPECT_EQ(model.sfm.points.size(), 5U);
}

// As in LLFF's scenes: IMG_4000.JPG in COLMAP's model is image000.png in images_4.
TEST_F(DataSets, SmallerPicturesOfOtherNamesAreMatchedInTheirOrder) {
  test::MadeSet set = test::MakeMip360(folder_.path());
  fs::create_directories(folder_ / "images");
  test::MadeSet renamed = set;
  renamed.names.clear();
  renamed.test.clear();
  for (size_t i = 0; i < set.names.size(); ++i) {
    const std::string name = "image" + set.names[i].substr(5, 3) + ".png";
    fs::rename(folder_ / "images_4" / set.names[i], folder_ / "images_4" / name);
    image::SavePng(image::Image8(4, 4, 3, 0), folder_ / "images" / set.names[i]);
    renamed.names.push_back(name);
    if (i % 8 == 0) renamed.test.push_back(name);
  }
  renamed.ray = [original = set.ray](const std::string& name, int i, int j) { return original("_DSC8" + name.substr(5), i, j); };
  const models::InputModel model = Read(renamed);
  ExpectRays(model, renamed);
  EXPECT_EQ(model.test_photos, Set(renamed.test));
}

TEST_F(DataSets, MatrixCity) {
  const test::MadeSet set = test::MakeMatrixCitySplit(folder_.path());
  const models::InputModel model = Read(set);
  EXPECT_EQ(model.set, "MatrixCity");
  ExpectRays(model, set);
  EXPECT_EQ(model.test_photos, Set(set.test));
  EXPECT_EQ(taken_, set.names);  // no other block
  EXPECT_EQ(model.metres_per_unit, 100.0);
  EXPECT_EQ(model.up, std::optional<Eigen::Vector3d>(Eigen::Vector3d::UnitZ()));
  const std::vector<georeference::ScaleBar> bars = BarsByModel(model);
  ASSERT_EQ(bars.size(), 1U);
  EXPECT_EQ(bars[0].length_m, 100.0 * (*bars[0].at_a - *bars[0].at_b).norm());
}

TEST_F(DataSets, OneBlockOfMatrixCity) {
  const test::MadeSet set = test::MakeMatrixCityBlock(folder_.path());
  const models::InputModel model = Read(set);
  EXPECT_EQ(model.set, "MatrixCity");
  ExpectRays(model, set);
  EXPECT_TRUE(model.test_photos.empty());
  EXPECT_EQ(model.metres_per_unit, 1.0);
}

// Gives every file of the set's split a PLY with points in front of the cameras.
void AddPoints(const test::MadeSet& set) {
  std::string ply = "ply\nformat ascii 1.0\nelement vertex 60\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  for (int i = 0; i < 60; ++i) ply += fmt::format("{} {} {}\n", 0.1 * (i % 5) - 0.2, 0.1 * (i / 5 % 4) - 0.15, 0.05 * (i / 20));
  base::WriteFileAtomically(set.model / "points.ply", ply);
  for (const fs::directory_entry& entry : fs::directory_iterator(set.model)) {
    if (entry.path().extension() != ".json") continue;
    nlohmann::json file = base::ParseJson(base::ReadFile(entry.path()));
    file["ply_file_path"] = "points.ply";
    base::WriteFileAtomically(entry.path(), base::JsonText(file));
  }
}

// The survey's frame is the set's, moved and scaled: z stays up.
void ExpectRaysOfSurvey(const survey::Survey& survey, const test::MadeSet& set, double metres_per_unit) {
  ASSERT_EQ(survey.photos.size(), set.names.size());
  const Eigen::Vector3d first = survey.photos[0].cam_from_enu.OriginInSource();
  const Eigen::Vector3d first_in_set = set.ray(survey.photos[0].name, 0, 0).origin;
  for (const survey::Photo& photo : survey.photos) {
    const Eigen::Vector3d from_first = photo.cam_from_enu.OriginInSource() - first;
    const test::SetRay expected = set.ray(photo.name, 31, 4);
    EXPECT_LT((from_first - metres_per_unit * (expected.origin - first_in_set)).norm(), 1e-6 * metres_per_unit) << photo.name;
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    EXPECT_LT((photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({31.5, 4.5}) - expected.direction).norm(), 1e-6) << photo.name;
    EXPECT_EQ(photo.is_test, std::find(set.test.begin(), set.test.end(), photo.name) != set.test.end()) << photo.name;
  }
}

TEST_F(DataSets, MatrixCityIsPreparedInMetres) {
  const test::MadeSet set = test::MakeMatrixCitySplit(folder_ / "data");
  AddPoints(set);
  const survey::Survey survey = Prepare({set.photo_root, set.model, folder_ / "out"}, {}, threads_);
  EXPECT_FALSE(survey.georeferenced);
  ExpectRaysOfSurvey(survey, set, 100.0);
  EXPECT_NEAR(survey.fit.scale, 100.0, 1e-9);
  EXPECT_TRUE(survey.unregistered.empty());
}

TEST_F(DataSets, BlenderIsPreparedOverWhiteWithoutMasks) {
  const test::MadeSet set = test::MakeBlender(folder_ / "data");
  AddPoints(set);
  image::Image8 rgba(test::kSetWidth, test::kSetHeight, 4, 0);
  base::WriteFileAtomically(set.photo_root / "train/r_1.png", image::EncodePng(rgba, 1));
  const survey::Survey masked = Prepare({set.photo_root, set.model, folder_ / "masked"}, {}, threads_);
  PrepareOptions options;
  options.alpha = "white";
  const survey::Survey filled = Prepare({set.photo_root, set.model, folder_ / "filled"}, options, threads_);
  for (const survey::Survey* survey : {&masked, &filled}) ExpectRaysOfSurvey(*survey, set, survey->fit.scale);
  const auto photo = [](const survey::Survey& survey) {
    return *std::find_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& one) { return one.name == "train/r_1.png"; });
  };
  EXPECT_FALSE(photo(masked).mask.empty());
  EXPECT_TRUE(photo(filled).mask.empty());
  EXPECT_EQ(image::LoadRgb8(filled.photo_root / "train/r_1.png").data, image::Image8(test::kSetWidth, test::kSetHeight, 3, 255).data);
  EXPECT_EQ(filled.unregistered, std::vector<std::string>());
}

}  // namespace
}  // namespace skyquilt::prepare
