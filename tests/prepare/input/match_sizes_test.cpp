#include "prepare/input/match_sizes.h"

#include <gtest/gtest.h>

#include "tests/support/in_temporary_folder.h"

namespace skyquilt::prepare::input {
namespace {

using ScaleToPhotosTest = InTemporaryFolder;

namespace fs = std::filesystem;

// Three photos of camera 1, two of camera 2; each photo observes point 7 at (200, 100).
struct SizedModel {
  survey::ColmapModel model;
  survey::ColmapObservations observations;
  std::vector<PhotoFile> photos;

  SizedModel() {
    model.cameras[1] = {camera::CameraModel::kRadial, 4000, 3000, {3000.0, 2010.0, 1490.0, -0.1, 0.05}};
    model.cameras[2] = {camera::CameraModel::kPinhole, 1000, 750, {800.0, 800.0, 500.0, 375.0}};
    survey::ColmapPoint point;
    point.id = 7;
    for (uint32_t id = 1; id <= 5; ++id) {
      survey::ColmapImage image;
      image.id = id;
      image.camera_id = id <= 3 ? 1 : 2;
      image.name = "p" + std::to_string(id) + ".jpg";
      model.images.push_back(image);
      observations[id] = {{7, {200.0, 100.0}}};
      point.image_ids.push_back(id);
      PhotoFile photo;
      photo.name = image.name;
      photo.width = model.cameras[image.camera_id].width;
      photo.height = model.cameras[image.camera_id].height;
      photos.push_back(photo);
    }
    model.points.push_back(point);
  }
  void SetSize(size_t photo, int width, int height) {
    photos[photo].width = width;
    photos[photo].height = height;
  }
};

TEST(IsScaledSize, AgreesToAPixelOfTheSmallerOne) {
  EXPECT_TRUE(IsScaledSize(4000, 3000, 1000, 750));
  EXPECT_TRUE(IsScaledSize(1000, 750, 4000, 3000));
  EXPECT_TRUE(IsScaledSize(5472, 3648, 1368, 912));
  // 4001 / 4 and 2999 / 4, rounded up or down.
  EXPECT_TRUE(IsScaledSize(4001, 2999, 1000, 749));
  EXPECT_TRUE(IsScaledSize(4001, 2999, 1001, 750));
  EXPECT_TRUE(IsScaledSize(640, 480, 640, 480));
  // Turned, cropped, another format.
  EXPECT_FALSE(IsScaledSize(4000, 3000, 3000, 4000));
  EXPECT_FALSE(IsScaledSize(4000, 3000, 4000, 2250));
  EXPECT_FALSE(IsScaledSize(4000, 3000, 1000, 667));
  EXPECT_FALSE(IsScaledSize(0, 0, 10, 10));
}

TEST_F(ScaleToPhotosTest, LeavesModelsOfTheSameSizeAlone) {
  SizedModel made;
  const survey::ColmapModel before = made.model;
  EXPECT_EQ(ScaleToPhotos(FindPhotos(made.model, made.photos), made.photos, folder_ / "model", true, folder_ / "scaled", made.model),
            folder_ / "model");
  EXPECT_EQ(made.model.cameras.at(1).params, before.cameras.at(1).params);
  EXPECT_FALSE(fs::exists(folder_ / "scaled"));
}

TEST_F(ScaleToPhotosTest, ScalesCamerasAndObservations) {
  SizedModel made;
  survey::WriteColmapBinary(made.model, made.observations, folder_ / "model");
  for (size_t i = 0; i < 3; ++i) made.SetSize(i, 1000, 750);
  const fs::path scaled = ScaleToPhotos(FindPhotos(made.model, made.photos), made.photos, folder_ / "model", true, folder_ / "scaled", made.model);
  EXPECT_EQ(scaled, folder_ / "scaled");
  EXPECT_EQ(made.model.cameras.size(), 2U);
  EXPECT_EQ(made.model.cameras.at(1).width, 1000);
  EXPECT_EQ(made.model.cameras.at(1).params, (std::vector<double>{750.0, 502.5, 372.5, -0.1, 0.05}));
  EXPECT_EQ(made.model.cameras.at(2).width, 1000);
  const survey::ColmapObservations read = survey::ReadColmapObservations(scaled);
  EXPECT_EQ(read.at(2).front().pixel, Eigen::Vector2d(50.0, 25.0));
  EXPECT_EQ(read.at(4).front().pixel, Eigen::Vector2d(200.0, 100.0));
  EXPECT_EQ(survey::ReadColmapModel(scaled).points.front().image_ids.size(), 5U);
  // Then all can be used.
  EXPECT_EQ(MatchPhotos(made.model, made.photos, folder_ / "model", folder_ / "photos").size(), 5U);
}

TEST_F(ScaleToPhotosTest, PhotosOfOneCameraMayHaveSeveralSizes) {
  SizedModel made;
  made.SetSize(1, 8000, 6000);
  made.SetSize(2, 4000, 2000);  // cropped
  EXPECT_EQ(ScaleToPhotos(FindPhotos(made.model, made.photos), made.photos, folder_ / "model", false, folder_ / "scaled", made.model),
            folder_ / "model");
  EXPECT_EQ(made.model.cameras.size(), 3U);
  EXPECT_EQ(made.model.images[0].camera_id, 1U);
  EXPECT_EQ(made.model.images[1].camera_id, 3U);
  EXPECT_EQ(made.model.cameras.at(3).params[0], 6000.0);
  EXPECT_EQ(made.model.images[2].camera_id, 1U);
  EXPECT_EQ(made.model.cameras.at(1).width, 4000);
  const FileOfImage usable = MatchPhotos(made.model, made.photos, folder_ / "model", folder_ / "photos");
  EXPECT_EQ(usable.size(), 4U);
  EXPECT_FALSE(usable.contains(3));
}

TEST_F(ScaleToPhotosTest, ModelsWithoutObservationsKeepTheirFolder) {
  SizedModel made;
  for (size_t i = 0; i < 3; ++i) made.SetSize(i, 2000, 1500);
  // None can be read there.
  EXPECT_EQ(ScaleToPhotos(FindPhotos(made.model, made.photos), made.photos, folder_ / "absent", true, folder_ / "scaled", made.model),
            folder_ / "absent");
  EXPECT_EQ(made.model.cameras.at(1).width, 2000);
  // Tracks whose observations are missing are left out.
  SizedModel bare;
  survey::WriteColmapText({bare.model.cameras, bare.model.images, {}, {}}, folder_ / "bare");
  for (size_t i = 0; i < 3; ++i) bare.SetSize(i, 2000, 1500);
  const fs::path scaled = ScaleToPhotos(FindPhotos(bare.model, bare.photos), bare.photos, folder_ / "bare", true, folder_ / "scaled", bare.model);
  EXPECT_TRUE(survey::ReadColmapModel(scaled).points.front().image_ids.empty());
}

}  // namespace
}  // namespace skyquilt::prepare::input
