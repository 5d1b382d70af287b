#include "evaluate/photos/load_held_out_photo.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/image/normal_image.h"
#include "tests/evaluate/photos/nadir_view.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::photos {
namespace {

// A survey of one photo in a sub-folder, with true depth, normals and classes of other sizes than the photo.
struct OnePhoto {
  TemporaryFolder folder;
  survey::Survey survey;
  base::ThreadPool threads{1};

  OnePhoto() {
    for (const char* name : {"images/a", "depth", "normals/a", "classes"}) std::filesystem::create_directories(folder.path() / name);
    image::SavePng(image::Image8(100, 80, 3, 90), folder.path() / "images/a/one.png");
    image::SaveFloatTiff(image::ImageF(4, 3, 1, 25.0F), folder.path() / "depth/one.tiff");
    image::ImageF normals(4, 3, 3, 0.0F);
    for (size_t i = 0; i < normals.data.size(); i += 3) normals.data[i] = 1.0F;
    image::SaveNormals(normals, folder.path() / "normals/a/one.png");
    image::SavePng(image::Image8(4, 3, 1, 8), folder.path() / "classes/one.png");
    const TrainingView view = NadirView(0, 0, 25);
    survey.georeferenced = true;
    survey.photo_root = folder.path() / "images";
    survey.cameras = {view.camera};
    survey.photos.resize(1);
    survey.photos[0].name = "a/one.png";
    survey.photos[0].cam_from_enu = view.cam_from_enu;
    survey.truth = survey::Truth{.depth_folder = folder.path() / "depth", .buildings_json = {}, .exposure_json = {}};
    survey.truth->normals_folder = folder.path() / "normals";
    survey.truth->classes_folder = folder.path() / "classes";
  }
  HeldOutPhoto Load() {
    const image::PixelCache pixels = image::PixelCache::Open(folder.path() / "pixels.bin", {{survey.photo_root / "a/one.png", {}}}, 0, threads);
    return LoadHeldOutPhoto(survey, pixels, 0, 0);
  }
};

TEST(LoadHeldOutPhoto, BringsTheTrueSurface) {
  OnePhoto one;
  const HeldOutPhoto photo = one.Load();
  EXPECT_EQ(photo.photo.width, 100);
  ASSERT_EQ(photo.true_depth.data.size(), 12U);
  EXPECT_EQ(photo.true_depth.data[5], 25.0F);
  ASSERT_EQ(photo.true_normals.data.size(), 36U);
  EXPECT_NEAR(photo.true_normals.data[6], 1.0F, 1e-4F);
  ASSERT_EQ(photo.true_class.data.size(), 12U);
  EXPECT_EQ(photo.true_class.data[11], 8);
}

TEST(LoadHeldOutPhoto, WithoutATruthThereIsNone) {
  OnePhoto one;
  one.survey.truth->normals_folder.clear();  // as of an earlier version
  one.survey.truth->classes_folder.clear();
  const HeldOutPhoto earlier = one.Load();
  EXPECT_FALSE(earlier.true_depth.Empty());
  EXPECT_TRUE(earlier.true_normals.Empty());
  EXPECT_TRUE(earlier.true_class.Empty());
  one.survey.georeferenced = false;  // no metres to compare with
  EXPECT_TRUE(one.Load().true_depth.Empty());
  one.survey.truth.reset();
  one.survey.georeferenced = true;
  EXPECT_TRUE(one.Load().true_depth.Empty());
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
