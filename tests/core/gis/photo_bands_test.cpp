#include "core/gis/photo_bands.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/raw_tiff.h"

namespace skyquilt::gis {
namespace {

using PhotoBandsTest = InTemporaryFolder;

// Band b (from 1) of pixel (x, y) is 1000 b + 10 y + x.
std::string FiveBands() {
  std::vector<uint16_t> values;
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 4; ++x) {
      for (int band = 1; band <= 5; ++band) values.push_back(static_cast<uint16_t>(1000 * band + 10 * y + x));
    }
  }
  return test::TiffBytes(
      {.width = 4, .height = 3, .bands = 5, .photometric = 1, .extra = {0, 0, 0, 0}, .pixels = test::LittleEndian<uint16_t>(values)});
}

TEST_F(PhotoBandsTest, ReadsAnyBandsOfAnyRows) {
  base::WriteFileAtomically(folder_ / "five.tif", FiveBands());
  const PhotoBands photo(folder_ / "five.tif");
  EXPECT_EQ(photo.width(), 4);
  EXPECT_EQ(photo.height(), 3);
  EXPECT_EQ(photo.bands(), 5);
  EXPECT_EQ(photo.Names(), std::vector<std::string>(5));
  std::vector<float> values(2 * 4 * 2);
  photo.ReadRows(1, 2, std::vector<int>{5, 2}, values);
  EXPECT_EQ(values[0], 5010.0F);
  EXPECT_EQ(values[1], 2010.0F);
  EXPECT_EQ(values[2], 5011.0F);
  EXPECT_EQ(values[15], 2023.0F);
}

TEST_F(PhotoBandsTest, NumbersOfFloatingPointStayAndNanIsZero) {
  const std::vector<float> values = {0.25F, -3.0F, std::numeric_limits<float>::quiet_NaN(), 1e6F};
  base::WriteFileAtomically(folder_ / "float.tif", test::TiffBytes({.width = 4,
                                                                    .height = 1,
                                                                    .bands = 1,
                                                                    .bits = 32,
                                                                    .floating = true,
                                                                    .photometric = 1,
                                                                    .extra = {},
                                                                    .pixels = test::LittleEndian<float>(values)}));
  std::vector<float> read(4);
  PhotoBands(folder_ / "float.tif").ReadRows(0, 1, std::vector<int>{1}, read);
  EXPECT_EQ(read, (std::vector<float>{0.25F, -3.0F, 0.0F, 1e6F}));
}

TEST_F(PhotoBandsTest, DamagedFilesAreNamed) {
  const std::string whole = FiveBands();
  base::WriteFileAtomically(folder_ / "cut.tif", whole.substr(0, whole.size() - 50));
  base::WriteFileAtomically(folder_ / "notes.tif", "these are only notes");
  std::vector<float> values(12);
  const std::string cut = InputErrorOf([&] { PhotoBands(folder_ / "cut.tif").ReadRows(0, 3, std::vector<int>{1}, values); });
  EXPECT_NE(cut.find("cut.tif: cannot be decoded"), std::string::npos) << cut;
  EXPECT_NE(InputErrorOf([&] { PhotoBands(folder_ / "notes.tif"); }).find("notes.tif"), std::string::npos);
  EXPECT_NE(InputErrorOf([&] { PhotoBands(folder_ / "absent.tif"); }).find("absent.tif"), std::string::npos);
}

}  // namespace
}  // namespace skyquilt::gis
