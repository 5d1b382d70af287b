#include "core/survey/refined_poses.h"

#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/colmap_model.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::survey {
namespace {

Survey ThreePhotos() {
  Survey survey;
  camera::Camera camera;
  camera.width = 400;
  camera.height = 300;
  camera.params = {350.0, 350.0, 200.0, 150.0};
  survey.cameras = {camera};
  for (int i = 0; i < 3; ++i) survey.photos.push_back(NadirPhoto({10.0 * i, 5.0, 60.0}, "flight/p" + std::to_string(i) + ".jpg"));
  survey.photos[2].is_test = true;
  return survey;
}

RefinedPoses TwoOffsets() {
  return {{{"flight/p1.jpg", {{0.001, -0.002, 0.0005}, {0.1, -0.2, 0.05}}, 1.25},
           {"flight/p2.jpg", {{0.1, 0.1, 0.1}, {1.0, 1.0, 1.0}}, 99.0},
           {"gone.jpg", {{0.1, 0.1, 0.1}, {1.0, 1.0, 1.0}}, 99.0}}};
}

TEST(RefinedPoses, MoveOnlyTrainingPhotosThatAreNamed) {
  const Survey given = ThreePhotos();
  Survey refined = given;
  ApplyRefinedPoses(TwoOffsets(), refined);
  for (const size_t same : {0U, 2U}) {
    EXPECT_EQ(refined.photos[same].cam_from_enu.translation, given.photos[same].cam_from_enu.translation) << same;
    EXPECT_EQ(refined.photos[same].cam_from_enu.rotation.coeffs(), given.photos[same].cam_from_enu.rotation.coeffs()) << same;
  }
  const geo::Rigid3d before = given.photos[1].cam_from_enu.Inverse(), after = refined.photos[1].cam_from_enu.Inverse();
  // The camera looks down: its x is east, its y south and its z down.
  EXPECT_LT((after.translation - before.translation - Eigen::Vector3d(0.1, 0.2, -0.05)).norm(), 1e-12);
  const PoseOffset back = OffsetBetween(before, after);
  EXPECT_LT((back.rotation - TwoOffsets().photos[0].offset.rotation).norm(), 1e-12);
  EXPECT_LT((back.translation - TwoOffsets().photos[0].offset.translation).norm(), 1e-12);
}

TEST(RefinedPoses, AreReadAsTheyWereWritten) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "survey";
  EXPECT_FALSE(LoadRefinedPoses(folder).has_value());
  const Survey survey = ThreePhotos();
  const RefinedPoses poses = TwoOffsets();
  SaveRefinedPoses(poses, survey, folder);
  const std::optional<RefinedPoses> read = LoadRefinedPoses(folder);
  ASSERT_TRUE(read.has_value());
  ASSERT_EQ(read->photos.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(read->photos[i].name, poses.photos[i].name);
    EXPECT_LT((read->photos[i].offset.rotation - poses.photos[i].offset.rotation).norm(), 1e-15);
    EXPECT_EQ(read->photos[i].offset.translation, poses.photos[i].offset.translation);
    EXPECT_EQ(read->photos[i].moved_px, poses.photos[i].moved_px);
  }
  // Other programs read the same poses.
  Survey refined = survey;
  ApplyRefinedPoses(*read, refined);
  const ColmapModel model = ReadColmapModel(RefinedPosesFolder(folder) / "sparse");
  ASSERT_EQ(model.images.size(), 3U);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(model.images[i].name, refined.photos[i].name);
    EXPECT_LT((model.images[i].cam_from_world.translation - refined.photos[i].cam_from_enu.translation).norm(), 1e-9);
  }
  RemoveRefinedPoses(folder);
  EXPECT_FALSE(LoadRefinedPoses(folder).has_value());
}

TEST(RefinedPoses, OfADamagedFileAreRefused) {
  const TemporaryFolder temporary;
  const std::filesystem::path folder = temporary / "survey";
  SaveRefinedPoses(TwoOffsets(), ThreePhotos(), folder);
  const std::filesystem::path file = RefinedPosesFolder(folder) / "poses.json";
  const std::string good = base::ReadFile(file);
  for (const char* bad : {"{", "{}", R"({"format": "skyquilt refined poses", "version": 9})",
                          R"({"format": "skyquilt refined poses", "version": 1, "photos": [{"name": "a", "rotation_deg": [1, 2]}]})"}) {
    base::WriteFileAtomically(file, bad);
    EXPECT_THROW(LoadRefinedPoses(folder), base::InputError) << bad;
  }
  base::WriteFileAtomically(file, good);
  EXPECT_TRUE(LoadRefinedPoses(folder).has_value());
}

TEST(RefinedPoses, SayHowFarTheyMoved) {
  const OffsetSizes sizes = SizesOf({{{"a", {{0.0, 0.0, 0.01}, {0.3, 0.0, 0.4}}, 3.0}, {"b", {{0.0, 0.0, 0.0}, {0.0, 0.1, 0.0}}, 1.0}}});
  EXPECT_NEAR(sizes.median_m, 0.3, 1e-12);
  EXPECT_NEAR(sizes.largest_m, 0.5, 1e-12);
  EXPECT_NEAR(sizes.largest_deg, 0.572957795, 1e-9);
  EXPECT_NEAR(sizes.median_px, 2.0, 1e-12);
}

}  // namespace
}  // namespace skyquilt::survey
