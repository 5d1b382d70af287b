#include "evaluate/page/masks_section.h"

#include <gtest/gtest.h>

#include "core/base/file.h"
#include "core/image/image.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::evaluate::page {
namespace {

class MasksSectionTest : public testing::Test {
 protected:
  // Photo i has 1000 pixels, 10 i of them ignored by the network.
  void Write(int n_photos) {
    survey::MadeMasks masks{.network = "people & cars.onnx", .classes = {"person", "car"}};
    for (int i = 0; i < n_photos; ++i) {
      const std::string name = std::to_string(i) + ".jpg";
      masks.photos.push_back({.photo = name, .look = i == 0 ? "" : "look/" + name + ".jpg", .pixels = 1000, .ignored = 10 * i, .network = 10 * i});
      if (i == 0) continue;
      std::filesystem::create_directories(Survey() / "made_masks/look");
      image::SaveJpeg(image::Image8(40, 30, 3, static_cast<uint8_t>(i)), Survey() / "made_masks" / masks.photos.back().look, 90);
    }
    survey::SaveMadeMasks(masks, Survey());
  }
  std::filesystem::path Survey() const { return folder_ / "survey"; }
  TemporaryFolder folder_;
};

TEST_F(MasksSectionTest, ShowsCountsAndPhotosFromTheMostIgnoredOn) {
  Write(12);
  const MasksReport report = CopyMasks(folder_.path(), folder_ / "report");
  ASSERT_EQ(report.pictures.size(), kMaskPictures);
  EXPECT_EQ(report.pictures.front().photo, "11.jpg");
  EXPECT_DOUBLE_EQ(report.pictures.front().ignored, 0.11);
  EXPECT_EQ(report.pictures.back().photo, "1.jpg");
  for (const MaskPicture& picture : report.pictures) EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / picture.image)) << picture.image;
  const std::string html = MasksSection(report);
  EXPECT_NE(html.find("people &amp; cars.onnx: person, car"), std::string::npos) << html;
  EXPECT_NE(html.find("660"), std::string::npos) << html;    // pixels
  EXPECT_NE(html.find("5.50"), std::string::npos) << html;   // percent of 12000
  EXPECT_NE(html.find("11.00"), std::string::npos) << html;  // of the first photo
  EXPECT_EQ(html.find("on ground inside"), std::string::npos) << html;
}

TEST_F(MasksSectionTest, IsLeftOutWithoutMasks) {
  EXPECT_EQ(MasksSection(CopyMasks(folder_.path(), folder_ / "report")), "");
  Write(3);
  base::WriteFileAtomically(survey::MadeMasksFile(Survey()), "{");
  EXPECT_EQ(MasksSection(CopyMasks(folder_.path(), folder_ / "report")), "");
}

TEST_F(MasksSectionTest, PicturesThatAreMissingAreLeftOut) {
  Write(4);
  std::filesystem::remove(Survey() / "made_masks/look/2.jpg.jpg");
  const MasksReport report = CopyMasks(folder_.path(), folder_ / "report");
  EXPECT_EQ(report.pictures.size(), 2U);
  EXPECT_NE(MasksSection(report), "");
}

TEST_F(MasksSectionTest, ShowsWhatMoved) {
  survey::ComparedPhotos compared{.movers = "auto", .prefer = "latest", .compared = 0.81, .moved = 0.0123, .replaced = 0.25};
  compared.photos = {{.photo = "still.jpg"}, {.photo = "a/moved.jpg", .look = "a/moved.jpg.jpg", .rejected = 0.04}};
  const std::filesystem::path folder = folder_ / "movers";
  survey::SaveComparedPhotos(compared, folder);
  std::filesystem::create_directories(folder / "a");
  image::SaveJpeg(image::Image8(40, 30, 3), folder / "a/moved.jpg.jpg", 90);
  const MasksReport report = CopyMasks(folder_.path(), folder_ / "report");
  ASSERT_EQ(report.compared_pictures.size(), 1U);
  EXPECT_EQ(report.compared_pictures[0].photo, "a/moved.jpg");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report" / report.compared_pictures[0].image));
  const std::string html = MasksSection(report);
  for (const char* shown : {"81.00", "1.23", "25.00", "in 1 photo,", "2.00", "4.00"}) EXPECT_NE(html.find(shown), std::string::npos) << shown << html;
  compared.unclear = true;
  survey::SaveComparedPhotos(compared, folder);
  EXPECT_NE(MasksSection(CopyMasks(folder_.path(), folder_ / "report")).find("too much to tell"), std::string::npos);
  base::WriteFileAtomically(folder / "movers.json", "[]");
  EXPECT_EQ(MasksSection(CopyMasks(folder_.path(), folder_ / "report")), "");
}

}  // namespace
}  // namespace skyquilt::evaluate::page
