#include <gtest/gtest.h>

#include "bench/study/priors_parts.h"
#include "bench/study/scene_views.h"
#include "core/base/file.h"
#include "core/survey/surface_class.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::bench {
namespace {

using CropsOfPriorsTest = InTemporaryFolder;

namespace fs = std::filesystem;

constexpr int kWidth = 400, kHeight = 300;

void Save(const fs::path& folder, const PriorResults& of, int view, const std::string& kind, uint8_t value, int channels = 3) {
  const fs::path views = folder / of.seeds.front().views;
  base::RequireWritableFolder(views);
  image::SavePng(image::Image8(kWidth, kHeight, channels, value), views / ViewPicture(view, kind));
}

PriorResults VariantWith(const fs::path& folder, const std::string& name, uint8_t render, int n_views) {
  PriorResults results{.name = name, .label = name, .seeds = {{}}};
  results.seeds.front().views = "runs/" + name + "_s1/views";
  for (int view = 0; view < n_views; ++view) {
    Save(folder, results, view, "photo", static_cast<uint8_t>(100 + view));
    Save(folder, results, view, "render", render);
    Save(folder, results, view, "normals", static_cast<uint8_t>(render + 1));
  }
  return results;
}

// Saves classes with a patch of the class; ground elsewhere.
void SaveClasses(const fs::path& folder, const PriorResults& of, int view, survey::SurfaceClass patch, int size) {
  image::Image8 classes(kWidth, kHeight, 1, static_cast<uint8_t>(survey::SurfaceClass::kGround));
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) *classes.At(x, y) = static_cast<uint8_t>(patch);
  }
  image::SavePng(classes, folder / of.seeds.front().views / ViewPicture(view, "classes"));
}

std::vector<std::string> Captions(const std::vector<CaptionedImage>& row) {
  std::vector<std::string> captions;
  captions.reserve(row.size());
  for (const CaptionedImage& cell : row) captions.push_back(cell.caption);
  return captions;
}

TEST_F(CropsOfPriorsTest, ShowEachClassInThePhotoThatHasMostOfIt) {
  std::vector<PriorResults> results = {VariantWith(folder_.path(), "none", 10, 3), VariantWith(folder_.path(), "planar", 20, 3),
                                       VariantWith(folder_.path(), "all", 30, 3)};
  SaveClasses(folder_.path(), results[0], 0, survey::SurfaceClass::kRoof, 10);
  SaveClasses(folder_.path(), results[0], 1, survey::SurfaceClass::kTree, 40);
  SaveClasses(folder_.path(), results[0], 2, survey::SurfaceClass::kRoof, 60);
  for (int view = 0; view < 3; ++view) Save(folder_.path(), results[0], view, "true_normals", 200);
  const std::vector<PriorCrops> crops = CropsOfPriors(results, folder_.path());
  ASSERT_EQ(crops.size(), 2U) << "no photo shows a wall";
  EXPECT_EQ(crops[0].id, "roofs");
  EXPECT_EQ(crops[1].id, "trees");
  EXPECT_EQ(*crops[0].colors[0].image.At(0, 0), 102) << "view 2 has more roof than view 0";
  EXPECT_EQ(*crops[1].colors[0].image.At(0, 0), 101);
  EXPECT_EQ(Captions(crops[0].colors), (std::vector<std::string>{"photo", "none", "all"}));
  EXPECT_EQ(Captions(crops[0].normals), (std::vector<std::string>{"true surface", "none, surface", "all, surface"}));
  EXPECT_EQ(*crops[0].colors[2].image.At(0, 0), 30);
  EXPECT_EQ(*crops[0].normals[0].image.At(0, 0), 200);
  EXPECT_EQ(*crops[0].normals[2].image.At(0, 0), 31);
  EXPECT_EQ(crops[0].colors[0].image.width, 320) << "160 pixels, enlarged twice";
  EXPECT_EQ(crops[0].colors[0].image.height, 240);
}

TEST_F(CropsOfPriorsTest, ShowTheMiddleOfARealSurvey) {
  std::vector<PriorResults> results = {VariantWith(folder_.path(), "none", 10, 6), VariantWith(folder_.path(), "planar", 20, 6)};
  const std::vector<PriorCrops> crops = CropsOfPriors(results, folder_.path());
  ASSERT_EQ(crops.size(), 3U);
  EXPECT_EQ(*crops[0].colors[0].image.At(0, 0), 101);
  EXPECT_EQ(*crops[1].colors[0].image.At(0, 0), 103);
  EXPECT_EQ(*crops[2].colors[0].image.At(0, 0), 105);
  EXPECT_EQ(Captions(crops[0].colors), (std::vector<std::string>{"photo", "none", "planar"}));
  EXPECT_EQ(Captions(crops[0].normals), (std::vector<std::string>{"photo", "none, surface", "planar, surface"}));
}

TEST_F(CropsOfPriorsTest, AreNoneWithoutPictures) {
  EXPECT_TRUE(CropsOfPriors({}, folder_.path()).empty());
  PriorResults failed{.name = "none", .label = "none", .seeds = {{}}};
  EXPECT_TRUE(CropsOfPriors({failed}, folder_.path()).empty());
  EXPECT_TRUE(WritePriorPictures({}, folder_.path()).empty());
  EXPECT_FALSE(fs::exists(folder_.path() / "priors.png"));
}

TEST(WritePriorPictures, WritesTheSheetAndEveryPictureOfThePage) {
  const TemporaryFolder folder;
  std::vector<PriorResults> results = {VariantWith(folder.path(), "none", 10, 3), VariantWith(folder.path(), "default", 20, 3)};
  const std::vector<BenchSection> sections = WritePriorPictures(CropsOfPriors(results, folder.path()), folder.path());
  ASSERT_EQ(sections.size(), 3U);
  for (const BenchSection& section : sections) {
    ASSERT_EQ(section.pictures.size(), 6U);
    for (const BenchPicture& picture : section.pictures) EXPECT_TRUE(fs::is_regular_file(folder.path() / picture.file)) << picture.file;
  }
  const image::Image8 sheet = image::LoadRgb8(folder.path() / "priors.png");
  EXPECT_GT(sheet.width, 3 * 320);
  EXPECT_GT(sheet.height, 6 * 240);
}

}  // namespace
}  // namespace skyquilt::bench
