#include "prepare/poses/seed/point_colors.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "core/image/image.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::test {
namespace {

// Left half of one colour, right half of another.
void SaveHalves(const std::filesystem::path& file, std::array<uint8_t, 3> left, std::array<uint8_t, 3> right) {
  image::Image8 image;
  image.width = 64;
  image.height = 48;
  image.channels = 3;
  for (int i = 0; i < image.width * image.height; ++i) {
    const auto& color = i % image.width < image.width / 2 ? left : right;
    image.data.insert(image.data.end(), color.begin(), color.end());
  }
  image::SavePng(image, file);
}

TEST(ColorPoints, GivesTheMeanOfThePhotosThatCanBeRead) {
  const TemporaryFolder folder;
  SaveHalves(folder / "a.png", {200, 100, 0}, {0, 0, 50});
  SaveHalves(folder / "b.png", {100, 50, 20}, {10, 20, 30});
  base::WriteFileAtomically(folder / "c.png", "no picture");
  survey::ColmapModel model;
  model.cameras.emplace(1, camera::Camera{camera::CameraModel::kPinhole, 64, 48, {60.0, 60.0, 32.0, 24.0}});
  for (const auto& [id, name] : {std::pair<uint32_t, std::string>{1, "a.png"}, {2, "b.png"}, {3, "c.png"}}) model.images.push_back({id, 1, name, {}});
  model.points = {{.id = 7, .image_ids = {1, 2, 3}}, {.id = 9, .image_ids = {1, 2}}, {.id = 11, .rgb = {1, 2, 3}, .image_ids = {3}}};
  // The last pixel of the first is on the photo's edge, where half a pixel more would be outside.
  const survey::ColmapObservations observations = {
      {1, {{7, {5.0, 5.0}}, {9, {64.0, 48.0}}}}, {2, {{7, {8.0, 40.0}}, {9, {60.0, 3.0}}}}, {3, {{7, {5.0, 5.0}}, {11, {5.0, 5.0}}}}};
  base::ThreadPool threads(2);
  prepare::poses::ColorPoints(model, observations, folder.path(), threads);
  EXPECT_EQ(model.points[0].rgb, (std::array<uint8_t, 3>{150, 75, 10}));
  EXPECT_EQ(model.points[1].rgb, (std::array<uint8_t, 3>{5, 10, 40}));
  EXPECT_EQ(model.points[2].rgb, (std::array<uint8_t, 3>{1, 2, 3}));
}

}  // namespace
}  // namespace skyquilt::test
