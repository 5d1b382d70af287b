#include "prepare/models/photo_names.h"

#include <gtest/gtest.h>

namespace skyquilt::prepare::models {
namespace {

TEST(PhotoNames, ThePathComesBeforeTheFileName) {
  const PhotoNames names({"a/1.JPG", "b/1.JPG", "b/2.jpg", "3.png", "3.png"});
  EXPECT_EQ(names.Find("b/1.JPG"), 1U);
  EXPECT_EQ(names.FindPath("1.JPG"), std::nullopt);
  // Two photos have this name.
  EXPECT_EQ(names.Find("c/1.JPG"), std::nullopt);
  EXPECT_EQ(names.Find("1"), std::nullopt);
  EXPECT_EQ(names.Find("D:\\flight\\2.JPG"), 2U);
  EXPECT_EQ(names.Find("elsewhere/3.PNG"), 3U);
}

TEST(PhotoNames, LabelsMayLackTheExtension) {
  const PhotoNames names({"DJI_0001.JPG", "DJI_0002.JPG", "DJI_0001"});
  EXPECT_EQ(names.Find("dji_0002"), 1U);
  // A photo of exactly this name, not the one with an extension.
  EXPECT_EQ(names.Find("DJI_0001"), 2U);
  EXPECT_EQ(names.FindFileName("dji_0001"), 2U);
  EXPECT_EQ(names.Find("DJI_0003"), std::nullopt);
  EXPECT_EQ(names.Find(""), std::nullopt);
}

TEST(PhotoNames, LabelsAreCleaned) {
  EXPECT_EQ(PhotoNames::Cleaned(".\\a\\..\\b.jpg"), "b.jpg");
}

TEST(PhotoNames, FoldersAboveTellPhotosOfOneNameApart) {
  const PhotoNames names({"100/DJI_1.JPG", "101/DJI_1.JPG", "b/101/DJI_1.JPG"});
  EXPECT_EQ(names.Find("D:\\Survey\\100\\dji_1.jpg"), 0U);
  EXPECT_EQ(names.Find("/home/b/101/DJI_1.JPG"), 2U);
  // Two of them lie in a folder of this name.
  EXPECT_EQ(names.Find("D:\\c\\101\\DJI_1.JPG"), std::nullopt);
  EXPECT_EQ(names.Find("DJI_1.JPG"), std::nullopt);
  EXPECT_EQ(names.CommonParts("x/101/DJI_1.JPG", 2), 2U);
  EXPECT_EQ(names.CommonParts("DJI_2.JPG", 2), 0U);
}

TEST(PhotoNames, QuotesAroundLabelsDoNotMatter) {
  const PhotoNames names({"my photo.JPG", "b.jpg"});
  EXPECT_EQ(names.Find("\"my photo.JPG\""), 0U);
  EXPECT_EQ(names.Find(" 'B' "), 1U);
}

}  // namespace
}  // namespace skyquilt::prepare::models
