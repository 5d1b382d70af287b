#include "evaluate/buildings/buildings_pictures.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/image/image.h"
#include "tests/evaluate/buildings/buildings_sample.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::buildings {
namespace {

TEST(CameraOfPart, SeesTheSamePartEnlarged) {
  using camera::CameraModel;
  const std::vector<std::pair<CameraModel, std::vector<double>>> lenses = {{CameraModel::kSimplePinhole, {500, 320, 240}},
                                                                           {CameraModel::kPinhole, {500, 510, 321, 239}},
                                                                           {CameraModel::kRadial, {500, 320, 240, -0.05, 0.01}},
                                                                           {CameraModel::kOpencv, {500, 505, 318, 243, -0.05, 0.01, 1e-3, -1e-3}}};
  const skyquilt::buildings::PhotoPart part{120, 80, 90, 60};
  for (const auto& [model, params] : lenses) {
    camera::Camera camera;
    camera.model = model;
    camera.width = 640;
    camera.height = 480;
    camera.params = params;
    const camera::Camera seen = CameraOfPart(camera, part, 3);
    EXPECT_EQ(seen.width, 270);
    EXPECT_EQ(seen.height, 180);
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(-0.3, -0.2, 1), Eigen::Vector3d(0.1, 0.2, 1), Eigen::Vector3d(-0.2, -0.1, 2)}) {
      const Eigen::Vector2d expected = 3.0 * (*camera.ImgFromCam(x) - Eigen::Vector2d(part.left, part.top));
      EXPECT_NEAR((*seen.ImgFromCam(x) - expected).norm(), 0.0, 1e-9) << camera::ModelName(model);
    }
  }
}

// One grey photo from 60 m above the first house of the town.
class PicturesOfTown : public testing::Test {
 protected:
  PicturesOfTown() {
    camera::Camera camera;
    camera.model = camera::CameraModel::kPinhole;
    camera.width = 640;
    camera.height = 480;
    camera.params = {600.0, 600.0, 320.0, 240.0};
    survey_.cameras = {camera};
    survey_.photo_root = folder_.path();
    survey::Photo photo;
    photo.name = "one.jpg";
    photo.cam_from_enu.rotation = Eigen::Quaterniond(0, 1, 0, 0);  // looks down, image up is north
    const Eigen::Vector3d at(6.0, 4.0, 160.0);
    photo.cam_from_enu.translation = -(photo.cam_from_enu.rotation * at);
    survey_.photos = {photo};
    image::SaveJpeg(image::Image8(640, 480, 3, 90), folder_ / "one.jpg", 90);
    std::filesystem::create_directories(folder_ / "report/images");
  }
  std::vector<BuildingPicture> Write(const std::vector<size_t>& chosen) {
    const image::PixelCache pixels = image::PixelCache::Open(folder_ / "pixels", {{folder_ / "one.jpg", {}}}, 320, threads_);
    if (without_file_) std::filesystem::remove(folder_ / "one.jpg");
    return WriteBuildingPictures(set_, chosen, survey_, pixels, folder_ / "report");
  }

  TemporaryFolder folder_;
  base::ThreadPool threads_{1};
  survey::Survey survey_;
  BuildingSet set_ = MadeTown(3);
  bool without_file_ = false;
};

TEST_F(PicturesOfTown, AreWrittenOfTheChosenThatAPhotoShows) {
  set_.buildings[2].shape.origin.x() += 1e5;
  for (Eigen::Vector3d& vertex : set_.buildings[2].lod22.vertex) vertex.x() += 1e5;
  for (Eigen::Vector3d& vertex : set_.buildings[2].lod12.vertex) vertex.x() += 1e5;
  for (Eigen::Vector2d& point : set_.buildings[2].footprint.outer) point.x() += 1e5;
  const std::vector<BuildingPicture> pictures = Write({2, 0});
  ASSERT_EQ(pictures.size(), 3U);
  EXPECT_EQ(pictures[0].file, "images/building_1.jpg");
  EXPECT_EQ(pictures[0].photo, "one.jpg");
  EXPECT_EQ(pictures[1].file, "") << "was not chosen";
  EXPECT_EQ(pictures[2].file, "") << "is in no photo";
  const image::Image8 written = image::LoadRgb8(folder_ / "report" / pictures[0].file);
  EXPECT_EQ(written.width, pictures[0].width);
  EXPECT_EQ(written.height, pictures[0].height);
  // The lines of the model are there, and the photo around them.
  size_t n_photo = 0;
  for (const uint8_t value : written.data) n_photo += std::abs(value - 90) <= 4 ? 1 : 0;
  EXPECT_GT(n_photo, written.data.size() / 2);
  EXPECT_LT(n_photo, written.data.size());
}

TEST_F(PicturesOfTown, AreTakenFromTheCacheWhereThePhotoIsGone) {
  without_file_ = true;
  EXPECT_EQ(Write({0})[0].file, "images/building_1.jpg");
}

}  // namespace
}  // namespace skyquilt::evaluate::buildings
