// HEIC and raw photos on their way from the folder to the pictures that all others read.
#include <gtest/gtest.h>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/develop.h"
#include "prepare/input/list_files.h"
#include "prepare/input/photo_files.h"
#include "prepare/input/plain_photos.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/made_photos_to_develop.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

using DevelopedPhotos = InTemporaryFolder;

constexpr int kRawWidth = 64, kRawHeight = 48;

std::string GreyDng(uint16_t value, int orientation) {
  return test::MadeDng(kRawWidth, kRawHeight, std::vector<uint16_t>(size_t{kRawWidth} * kRawHeight, value), 16'000, orientation);
}

TEST_F(DevelopedPhotos, AreReadWithTheirTagsAndWrittenAsPictures) {
  const fs::path photos = folder_ / "photos", made = folder_ / "made";
  fs::create_directories(photos);
  base::WriteFileAtomically(photos / "a.dng", GreyDng(3'200, 1));
  base::WriteFileAtomically(photos / "b.DNG", GreyDng(6'400, 6));
  image::SaveJpeg(image::Image8(kRawWidth, kRawHeight, 3, 90), photos / "c.jpg", 90);
  const bool has_heic = test::WriteHeic(image::Image8(kRawWidth, kRawHeight, 3, 100), photos / "d.HEIC", GreyDng(0, 8));
  base::ThreadPool threads(2);
  const std::vector<std::string> names = TakenNames(ListInput(photos, {}, threads));
  ASSERT_EQ(names.size(), has_heic ? 4U : 3U);
  PhotoSet set = ReadPhotos(photos, names, threads);
  ASSERT_EQ(set.usable.size(), names.size());
  for (const PhotoFile& photo : set.usable) {
    EXPECT_EQ(photo.width, kRawWidth) << photo.name;
    EXPECT_EQ(photo.height, kRawHeight) << photo.name;
  }
  EXPECT_EQ(set.usable[0].tags.model, "Made");
  EXPECT_EQ(set.usable[1].tags.orientation, 6);
  if (has_heic) {
    EXPECT_EQ(set.usable[3].tags.model, "Made") << "EXIF in HEIC";
    EXPECT_EQ(set.usable[3].tags.orientation, 8);
  }
  const fs::path pictures = MakePlainPhotos(photos, "", "mask", made, set, threads);
  EXPECT_EQ(pictures, made);
  for (size_t i = 0; i < set.usable.size(); ++i) {
    EXPECT_EQ(set.usable[i].converted, set.usable[i].name != "c.jpg");
    const image::Image8 picture = image::LoadRgb8(pictures / set.usable[i].name);
    EXPECT_EQ(picture.width, kRawWidth);
    if (set.usable[i].converted) EXPECT_EQ(picture.data, image::DevelopPhoto(photos / set.usable[i].name).data);
  }
  // A second call finds them.
  const auto time = fs::last_write_time(made / "a.dng");
  PhotoSet again = ReadPhotos(photos, names, threads);
  MakePlainPhotos(photos, "", "mask", made, again, threads);
  EXPECT_EQ(fs::last_write_time(made / "a.dng"), time);
}

TEST_F(DevelopedPhotos, ThoseThatCannotBeDevelopedAreLeftOut) {
  const fs::path photos = folder_ / "photos";
  fs::create_directories(photos);
  for (const char* name : {"a.dng", "b.dng", "c.dng"}) base::WriteFileAtomically(photos / name, GreyDng(3'200, 1));
  base::WriteFileAtomically(photos / "d.dng", GreyDng(3'200, 1).substr(0, 600));
  base::WriteFileAtomically(photos / "e.heic", "no picture");
  base::ThreadPool threads(2);
  PhotoSet set = ReadPhotos(photos, {"a.dng", "b.dng", "c.dng", "d.dng", "e.heic"}, threads);
  MakePlainPhotos(photos, "", "mask", folder_ / "made", set, threads);
  EXPECT_EQ(set.usable.size(), 3U);
  EXPECT_EQ(set.unreadable.size(), 2U);
}

}  // namespace
}  // namespace skyquilt::prepare::input
