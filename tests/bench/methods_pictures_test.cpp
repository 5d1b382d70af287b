#include <gtest/gtest.h>

#include "bench/study/methods_parts.h"
#include "bench/study/scene_views.h"
#include "core/base/file.h"
#include "core/image/image.h"
#include "core/survey/surface_class.h"
#include "tests/support/in_temporary_folder.h"

namespace skyquilt::bench {
namespace {

constexpr int kPhotoWidth = 400, kPhotoHeight = 300;

class MethodPictures : public InTemporaryFolder {
 protected:
  // Two views, whose photos have the values 100 and 101.
  VariantResult With(const std::string& name, uint8_t render) {
    VariantResult result;
    result.views = "runs/" + name + "/views";
    const std::filesystem::path views = folder_.path() / result.views;
    base::RequireWritableFolder(views);
    for (int view = 0; view < 2; ++view) {
      image::SavePng(image::Image8(kPhotoWidth, kPhotoHeight, 3, static_cast<uint8_t>(100 + view)), views / ViewPicture(view, "photo"));
      image::SavePng(image::Image8(kPhotoWidth, kPhotoHeight, 3, render), views / ViewPicture(view, "render"));
    }
    return result;
  }
  uint8_t ValueOf(const std::string& file) const { return *image::LoadRgb8(folder_.path() / file).At(0, 0); }
};

TEST_F(MethodPictures, ShowTheSamePartsOfAllMethods) {
  const std::vector<MethodPair> pairs = {{.name = "dvgo", .one = {}, .blocks = With("dvgo_blocks", 20)},
                                         {.name = "nerf", .network = true, .one = With("nerf_one", 30), .blocks = With("nerf_blocks", 40)}};
  const std::vector<BenchSection> sections = WriteMethodPictures(pairs, folder_.path());
  ASSERT_EQ(sections.size(), 2U);
  ASSERT_EQ(sections[0].pictures.size(), 2U) << "without classes the middles of two photos";
  EXPECT_EQ(ValueOf(sections[0].pictures[1].file), 101);
  ASSERT_EQ(sections[1].pictures.size(), 6U) << "the first method failed as one field";
  EXPECT_EQ(sections[1].pictures[2].caption, "nerf, one field");
  EXPECT_EQ(ValueOf(sections[1].pictures[3].file), 40);
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_.path() / "methods.png"));
  EXPECT_TRUE(WriteMethodPictures({{.name = "dvgo", .one = {}, .blocks = {}}}, folder_.path()).empty());
}

TEST_F(MethodPictures, ShowRoofsAndTreesWhereClassesAreKnown) {
  const MethodPair pair{.name = "dvgo", .one = With("dvgo_one", 20), .blocks = With("dvgo_blocks", 30)};
  image::Image8 classes(kPhotoWidth, kPhotoHeight, 1, static_cast<uint8_t>(survey::SurfaceClass::kGround));
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) *classes.At(x, y) = static_cast<uint8_t>(survey::SurfaceClass::kRoof);
  }
  image::SavePng(classes, folder_.path() / pair.one.views / ViewPicture(1, "classes"));
  const std::vector<BenchSection> sections = WriteMethodPictures({pair}, folder_.path());
  ASSERT_EQ(sections[0].pictures.size(), 1U) << "no tree";
  EXPECT_EQ(ValueOf(sections[0].pictures[0].file), 101);
  EXPECT_EQ(sections[1].pictures.size(), 2U);
}

}  // namespace
}  // namespace skyquilt::bench
