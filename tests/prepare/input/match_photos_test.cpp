#include "prepare/input/match_photos.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace skyquilt::prepare::input {
namespace {

using NameList = std::vector<std::string>;

// The photo of each image in the images' order; empty: none.
NameList PhotosOfImages(const NameList& images, const NameList& photos) {
  survey::ColmapModel model;
  for (const std::string& name : images) {
    survey::ColmapImage image;
    image.id = static_cast<uint32_t>(10 + model.images.size());
    image.name = name;
    model.images.push_back(image);
  }
  std::vector<PhotoFile> files(photos.size());
  for (size_t i = 0; i < photos.size(); ++i) files[i].name = photos[i];
  const FileOfImage found = FindPhotos(model, files);
  NameList names;
  for (const survey::ColmapImage& image : model.images) names.push_back(found.contains(image.id) ? files[found.at(image.id)].name : "");
  return names;
}

TEST(FindPhotos, ThePathDecidesBeforeTheFileName) {
  EXPECT_EQ(PhotosOfImages({"a/1.jpg", "b/1.jpg", "2.jpg"}, {"2.jpg", "a/1.jpg", "b/1.jpg"}), (NameList{"a/1.jpg", "b/1.jpg", "2.jpg"}));
  // The photo of the second image is not in the folder.
  EXPECT_EQ(PhotosOfImages({"a/1.jpg", "b/1.jpg"}, {"a/1.jpg"}), (NameList{"a/1.jpg", ""}));
  EXPECT_EQ(PhotosOfImages({"b/1.jpg", "a/1.jpg"}, {"a/1.jpg"}), (NameList{"", "a/1.jpg"}));
  // A longer path that ends in the same way is not the same.
  EXPECT_EQ(PhotosOfImages({"x/a/1.jpg", "a/1.jpg"}, {"a/1.jpg"}), (NameList{"", "a/1.jpg"}));
}

TEST(FindPhotos, TheFileNameAloneDecidesWhereItIsTheOnlyOne) {
  EXPECT_EQ(PhotosOfImages({"images/1.JPG", "./2.jpg"}, {"flight/1.jpg", "flight/2.jpg"}), (NameList{"flight/1.jpg", "flight/2.jpg"}));
  EXPECT_EQ(PhotosOfImages({"D:\\survey\\1.JPG"}, {"flight/1.jpg"}), (NameList{"flight/1.jpg"}));
  // Two images or two photos of one name, and nothing that tells them apart.
  EXPECT_EQ(PhotosOfImages({"a/1.jpg", "b/1.jpg"}, {"1.jpg"}), (NameList{"", ""}));
  EXPECT_EQ(PhotosOfImages({"1.jpg"}, {"a/1.jpg", "b/1.jpg"}), (NameList{""}));
  EXPECT_EQ(PhotosOfImages({"1.jpg", "1.jpg"}, {"1.jpg"}), (NameList{"", ""}));
  EXPECT_EQ(PhotosOfImages({"other.jpg"}, {"1.jpg"}), (NameList{""}));
  EXPECT_EQ(PhotosOfImages({}, {"1.jpg"}), NameList{});
}

TEST(FindPhotos, FoldersTellPhotosOfOneNameApart) {
  EXPECT_EQ(PhotosOfImages({"100/1.jpg", "101/1.jpg"}, {"flight/100/1.jpg", "flight/101/1.jpg"}), (NameList{"flight/100/1.jpg", "flight/101/1.jpg"}));
  EXPECT_EQ(PhotosOfImages({"images/100/1.jpg", "images/101/1.jpg"}, {"100/1.jpg", "101/1.jpg"}), (NameList{"100/1.jpg", "101/1.jpg"}));
  // Only one of the two has its photo in the folder.
  EXPECT_EQ(PhotosOfImages({"100/1.jpg", "101/1.jpg"}, {"flight/101/1.jpg"}), (NameList{"", "flight/101/1.jpg"}));
}

}  // namespace
}  // namespace skyquilt::prepare::input
