#include "prepare/input/masks/masks.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "core/base/random.h"
#include "prepare/input/input_folder.h"
#include "prepare/input/masks/mask_index.h"
#include "tests/prepare/input/made_folder.h"
#include "tests/support/error_of.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

constexpr int kWidth = 16, kHeight = 8;

// The left half is to be used.
image::Image8 LeftHalf(int width, int height, int channels = 1) {
  image::Image8 mask(width, height, channels, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width / 2; ++x) std::fill_n(mask.At(x, y), channels, uint8_t{255});
  }
  return mask;
}

class Masks : public ::testing::Test {
 protected:
  void Photos(const std::vector<std::string>& names) {
    for (const std::string& name : names) folder_.AddJpeg(name, kWidth, kHeight);
  }
  void Mask(const std::string& name) { folder_.AddPng(name, LeftHalf(kWidth, kHeight)); }

  // Of the photos that FindInputs and the list take; `photos` and `option` as the user gives them.
  PhotoMasks Find(const std::string& photos = "", const std::string& option = "") {
    const InputFolder input = FindInputs(folder_.path() / photos, {}, option);
    ListOptions options;
    options.skip = {out()};
    options.masks = input.masks.given;
    files_ = ListInput(input.photo_root, options, folder_.threads());
    photos_.clear();
    for (const std::string& name : TakenNames(files_)) {
      PhotoFile photo;
      photo.name = name;
      image::ReadImageSize(input.photo_root / name, &photo.width, &photo.height);
      photos_.push_back(photo);
    }
    found_ = FindMasks(input.photo_root, input.masks, out(), photos_, files_, folder_.threads());
    return found_;
  }
  // Where the photo's mask came from; empty: it has none.
  std::string OriginOf(const std::string& photo) const {
    for (size_t i = 0; i < photos_.size(); ++i) {
      if (photos_[i].name == photo) return found_.origin[i];
    }
    return "no such photo";
  }
  image::Image8 MaskOf(const std::string& photo) const { return image::LoadMask(found_.folder / (photo + ".png")); }
  fs::path out() const { return folder_.path() / "out"; }

  test::MadeFolder folder_;
  std::vector<InputFile> files_;
  std::vector<PhotoFile> photos_;
  PhotoMasks found_;
};

TEST_F(Masks, OfColmapsNamesInOneFolderStayWhereTheyAre) {
  Photos({"a.jpg", "sub/b.JPG", "c.jpg"});
  Mask("masks/a.jpg.png");
  Mask("masks/sub/b.JPG.png");
  Find();
  EXPECT_EQ(found_.folder, folder_.path() / "masks");
  EXPECT_EQ(photos_[0].mask, (folder_.path() / "masks/a.jpg.png").string());
  EXPECT_EQ(photos_[1].mask, "");
  EXPECT_EQ(photos_[2].mask, (folder_.path() / "masks/sub/b.JPG.png").string());
  EXPECT_EQ(OriginOf("sub/b.JPG"), "masks/sub/b.JPG.png");
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Masks, AreFoundBesideImagesWhenTheseAreGiven) {
  Photos({"images/a.jpg", "images/b.jpg"});
  Mask("masks/a.jpg.png");
  Mask("masks/b.jpg.png");
  for (const char* given : {"", "images"}) {
    Find(given);
    EXPECT_EQ(found_.folder, folder_.path() / "masks") << given;
    EXPECT_FALSE(OriginOf("a.jpg").empty() || OriginOf("b.jpg").empty()) << given;
  }
}

TEST_F(Masks, HaveTheNamesOfManyPrograms) {
  Photos({"a.jpg", "b.jpg", "c.JPG", "d.jpg", "e.jpg", "sub/f.jpg", "sub/g.jpg", "h.jpg"});
  Mask("a_mask.png");                               // OpenDroneMap, MicMac, Metashape
  Mask("b.jpg.png");                                // COLMAP
  Mask("masks/c.png");                              // COLMAP, tools for segments
  Mask("masks/D_MASK.png");                         // Windows
  folder_.AddJpeg("masks/e.jpg", kWidth, kHeight);  // of the photo's own name
  Mask("masks/f.png");                              // all in one folder
  Mask("sub/masks/g.jpg.png");                      // a folder per flight
  folder_.Add("h_mask.jpg");                        // replaced below: JPEG
  image::SaveJpeg(LeftHalf(kWidth, kHeight, 3), folder_.path() / "h_mask.jpg", 90);
  Find();
  EXPECT_EQ(OriginOf("a.jpg"), "a_mask.png");
  EXPECT_EQ(OriginOf("b.jpg"), "b.jpg.png");
  EXPECT_EQ(OriginOf("c.JPG"), "masks/c.png");
  EXPECT_EQ(OriginOf("d.jpg"), "masks/D_MASK.png");
  EXPECT_EQ(OriginOf("e.jpg"), "masks/e.jpg");
  EXPECT_EQ(OriginOf("sub/f.jpg"), "masks/f.png");
  EXPECT_EQ(OriginOf("sub/g.jpg"), "sub/masks/g.jpg.png");
  EXPECT_EQ(OriginOf("h.jpg"), "h_mask.jpg");
  EXPECT_EQ(photos_.size(), 8U);
  EXPECT_EQ(found_.folder, out());
  for (const char* photo : {"a.jpg", "sub/f.jpg", "h.jpg"}) EXPECT_EQ(MaskOf(photo).data, LeftHalf(kWidth, kHeight).data) << photo;
  for (const InputFile& file : files_) EXPECT_EQ(file.mask, file.Taken() ? OriginOf(file.name) : "") << file.name;
}

TEST_F(Masks, OfOneNameInSeveralFoldersAreNotMixedUp) {
  Photos({"flight1/DJI_0001.jpg", "flight2/DJI_0001.jpg"});
  Mask("masks/DJI_0001.png");
  EXPECT_NE(InputErrorOf([&] { Find(); }).find("DJI_0001.png"), std::string::npos);
  Mask("masks/flight2/DJI_0001.png");
  Find();
  EXPECT_EQ(OriginOf("flight1/DJI_0001.jpg"), "");
  EXPECT_EQ(OriginOf("flight2/DJI_0001.jpg"), "masks/flight2/DJI_0001.png");
}

TEST_F(Masks, OneMayServeAllPhotosOfACamera) {
  Photos({"a.jpg", "left/b.jpg", "right/c.jpg", "right/d.jpg"});
  Mask("masks/left.png");
  Mask("masks/mask.png");
  Mask("right/camera_mask.png");
  Mask("masks/right/d.jpg.png");
  Find();
  EXPECT_EQ(OriginOf("a.jpg"), "masks/mask.png");
  EXPECT_EQ(OriginOf("left/b.jpg"), "masks/left.png");
  EXPECT_EQ(OriginOf("right/c.jpg"), "right/camera_mask.png");
  EXPECT_EQ(OriginOf("right/d.jpg"), "masks/right/d.jpg.png");
}

TEST_F(Masks, TheOnlyFileOfAFolderServesAllPhotosUnlessItIsOnePhotosOwn) {
  Photos({"images/a.jpg", "images/b.jpg"});
  Mask("masks/propeller.png");
  Find("images");
  EXPECT_FALSE(OriginOf("a.jpg").empty() || OriginOf("b.jpg").empty());
  fs::rename(folder_.path() / "masks/propeller.png", folder_.path() / "masks/b.png");
  Find("images");
  EXPECT_EQ(OriginOf("a.jpg"), "");
  EXPECT_FALSE(OriginOf("b.jpg").empty());
}

TEST_F(Masks, AFileMayBeGivenForAllAndNoneMayBeAskedFor) {
  Photos({"a.jpg", "b.jpg"});
  Mask("masks/a.jpg.png");
  Mask("elsewhere/props.png");
  const std::string file = (folder_.path() / "elsewhere/props.png").string();
  EXPECT_EQ(Find("", file).origin, (std::vector<std::string>{"elsewhere/props.png", "elsewhere/props.png"}));
  // The photos' own folder: a photo is not its own mask.
  Mask("b.jpg.png");
  Find("", folder_.path().string());
  EXPECT_EQ(OriginOf("b.jpg"), "b.jpg.png");
  EXPECT_EQ(OriginOf("a.jpg"), "");  // that folder alone
  EXPECT_TRUE(Find("", "none").folder.empty());
  EXPECT_EQ(OriginOf("a.jpg"), "");
  EXPECT_NE(InputErrorOf([&] { Find("", "/no/such/folder"); }).find("/no/such/folder"), std::string::npos);
}

TEST_F(Masks, AreThoseThatTransformsJsonNames) {
  Photos({"images/frame_00001.jpg", "images/frame_00002.jpg"});
  Mask("segments/x.png");
  folder_.Add("transforms.json", R"({"frames": [{"file_path": "images/frame_00002.jpg", "mask_path": "segments/x.png"},
                                               {"file_path": "images/frame_00001.jpg", "mask_path": "segments/missing.png"}, 7]})");
  for (const char* given : {"", "images"}) {
    Find(given);
    EXPECT_EQ(OriginOf("frame_00001.jpg"), "");
    EXPECT_TRUE(OriginOf("frame_00002.jpg").ends_with("segments/x.png")) << given;
  }
  folder_.Add("transforms.json", "no JSON");
  Find();
  EXPECT_EQ(OriginOf("frame_00002.jpg"), "");
}

TEST_F(Masks, AlphaHidesWhatIsTransparent) {
  image::Image8 rgba = LeftHalf(kWidth, kHeight, 4);
  folder_.AddPng("a.png", rgba);
  std::fill(rgba.data.begin(), rgba.data.end(), uint8_t{255});
  folder_.AddPng("b.png", rgba);
  folder_.AddPng("c.png", image::Image8(kWidth, kHeight, 3, 50));
  Find();
  EXPECT_EQ(OriginOf("a.png"), "alpha");
  EXPECT_EQ(MaskOf("a.png").data, LeftHalf(kWidth, kHeight).data);
  EXPECT_EQ(OriginOf("b.png"), "") << "opaque everywhere";
  EXPECT_EQ(OriginOf("c.png"), "");
}

TEST_F(Masks, OpaqueAlphaLeavesOtherMasksWhereTheyAre) {
  folder_.AddPng("b.png", image::Image8(kWidth, kHeight, 4, 255));
  Photos({"a.jpg"});
  Mask("masks/a.jpg.png");
  EXPECT_EQ(Find().folder, folder_.path() / "masks");
}

TEST_F(Masks, OfAnotherSizeAreScaledAndOfAnotherShapeRefused) {
  Photos({"a.jpg", "b.jpg"});
  folder_.AddPng("masks/a.jpg.png", LeftHalf(2 * kWidth, 2 * kHeight));
  folder_.AddPng("masks/b.jpg.png", LeftHalf(kWidth / 4, kHeight / 4));
  Find();
  for (const char* photo : {"a.jpg", "b.jpg"}) EXPECT_EQ(MaskOf(photo).data, LeftHalf(kWidth, kHeight).data) << photo;
  folder_.AddPng("masks/b.jpg.png", LeftHalf(kHeight, kWidth));
  const std::string message = InputErrorOf([&] { Find(); });
  EXPECT_NE(message.find("b.jpg.png"), std::string::npos) << message;
  EXPECT_NE(message.find("8x16"), std::string::npos) << message;
}

TEST_F(Masks, ThatFitNothingAreAnErrorInAFolderOfMasks) {
  Photos({"a.jpg", "b.jpg"});
  Mask("masks/x.png");
  Mask("masks/y.png");
  const std::string message = InputErrorOf([&] { Find(); });
  for (const char* part : {"no mask for any photo", "x.png", "a.jpg.png", "prepare.masks = none"}) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }
  // With one that fits they are only named.
  Mask("masks/a.jpg.png");
  EXPECT_FALSE(Find().folder.empty());
}

// The time of a file is part of what COLMAP's features were made from.
TEST_F(Masks, EqualFilesStayUntouchedAndOldOnesGo) {
  Photos({"a.jpg", "b.jpg"});
  Mask("a_mask.png");
  Mask("b_mask.png");
  Find();
  const fs::file_time_type old = fs::last_write_time(out() / "a.jpg.png") - std::chrono::hours(1);
  fs::last_write_time(out() / "a.jpg.png", old);
  fs::remove(folder_.path() / "b_mask.png");
  Find();
  EXPECT_EQ(fs::last_write_time(out() / "a.jpg.png"), old);
  EXPECT_FALSE(fs::exists(out() / "b.jpg.png"));
}

RC_GTEST_PROP(MaskIndex, FindsEveryNamingOfEveryPhoto, ()) {
  base::Random random(static_cast<uint64_t>(*rc::gen::inRange(0, 1'000'000)));
  static const std::vector<std::string> endings = {".jpg.png", "_mask.png", ".png", "_MASK.JPG", ".tif"};
  std::vector<std::string> photos;
  const uint32_t n = 1 + random.Below(10);
  for (uint32_t i = 0; i < n; ++i) photos.push_back((random.Below(2) == 0 ? "flight/DJI_" : "DJI_") + std::to_string(1000 + i) + ".jpg");
  MaskIndex index(photos);
  std::vector<std::string> masks;
  for (const std::string& photo : photos) {
    const std::string ending = endings[random.Below(static_cast<uint32_t>(endings.size()))];
    masks.push_back(photo.substr(0, photo.size() - 4) + ending);
    index.Add(masks.back(), masks.back(), true);
  }
  for (size_t i = 0; i < photos.size(); ++i) {
    const std::optional<size_t> found = index.Find(photos[i]);
    RC_ASSERT(found.has_value());
    RC_ASSERT(index.File(*found) == masks[i]);
  }
  RC_ASSERT(index.Unfit().empty());
}

TEST(ModelsIn, AreFoundByTheirNames) {
  test::MadeFolder folder;
  folder.AddAll({"sparse/0/cameras.txt", "transforms.json", "transforms_train.json", "opensfm/reconstruction.json", "project.OPF", "notes.xml"});
  std::set<std::string> names;
  for (const fs::path& model : ModelsIn(folder.path())) names.insert(fs::relative(model, folder.path()).generic_string());
  EXPECT_EQ(names, (std::set<std::string>{"sparse/0", "transforms.json", "transforms_train.json", "opensfm/reconstruction.json", "project.OPF"}));
}

}  // namespace
}  // namespace skyquilt::prepare::input
