#include "prepare/input/plain_photos.h"

#include <gtest/gtest.h>

#include <chrono>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/image.h"
#include "prepare/input/band_choice.h"
#include "prepare/input/white_level.h"
#include "tests/support/error_of.h"
#include "tests/support/raw_tiff.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

class PlainPhotosTest : public ::testing::Test {
 protected:
  // `values`: of one pixel; all pixels are the same.
  template <typename T>
  void WriteTiff(const std::string& name, const std::vector<T>& values, int photometric, std::vector<uint16_t> extra = {},
                 std::map<uint16_t, uint16_t> more = {}) {
    std::vector<T> pixels;
    for (int i = 0; i < 6 * 4; ++i) pixels.insert(pixels.end(), values.begin(), values.end());
    fs::create_directories((folder_ / ("photos/" + name)).parent_path());
    base::WriteFileAtomically(folder_ / ("photos/" + name), test::TiffBytes({.width = 6,
                                                                             .height = 4,
                                                                             .bands = static_cast<int>(values.size()),
                                                                             .bits = static_cast<int>(8 * sizeof(T)),
                                                                             .floating = std::is_floating_point_v<T>,
                                                                             .photometric = photometric,
                                                                             .extra = std::move(extra),
                                                                             .pixels = test::LittleEndian<T>(pixels),
                                                                             .more = std::move(more)}));
    AddPhoto(name);
  }
  void AddPhoto(const std::string& name) {
    PhotoFile photo;
    photo.name = name;
    photo.width = 6;
    photo.height = 4;
    photos_.usable.push_back(photo);
  }
  // Other photos in the same place: file systems may give files that follow each other closely the same time.
  void StartAnew() {
    photos_ = {};
    fs::remove_all(folder_ / "made");
  }
  void WriteJpegPhoto(const std::string& name) {
    fs::create_directories(folder_ / "photos");
    image::SaveJpeg(image::Image8(6, 4, 3, 90), folder_ / ("photos/" + name), 90);
    AddPhoto(name);
  }
  fs::path Make(const std::string& bands = "", const std::string& alpha = "mask") {
    return MakePlainPhotos(folder_ / "photos", bands, alpha, folder_ / "made", photos_, threads_);
  }
  // The first pixel of what all others read.
  std::vector<uint8_t> Pixel(const fs::path& root, const std::string& name) {
    const image::Image8 image = image::LoadRgb8(root / name);
    EXPECT_EQ(image.width, 6);
    EXPECT_EQ(image.height, 4);
    return {image.data.begin(), image.data.begin() + 3};
  }

  TemporaryFolder folder_;
  PhotoSet photos_;
  base::ThreadPool threads_{2};
};

using Rgb = std::vector<uint8_t>;

TEST_F(PlainPhotosTest, PlainPhotosStayWhereTheyAre) {
  for (const char* name : {"a.jpg", "b.jpg", "c.jpg"}) WriteJpegPhoto(name);
  EXPECT_EQ(Make(), folder_ / "photos");
  EXPECT_FALSE(fs::exists(folder_ / "made"));
  EXPECT_FALSE(photos_.usable[0].converted);
}

// NeRF's readers: rgb * alpha + background * (1 - alpha) of the stored values.
TEST_F(PlainPhotosTest, TransparencyIsFilledAsAskedFor) {
  fs::create_directories(folder_ / "photos");
  image::Image8 rgba(6, 4, 4, 255);
  const std::vector<uint8_t> first = {200, 100, 0, 51};  // a fifth
  std::copy(first.begin(), first.end(), rgba.data.begin());
  base::WriteFileAtomically(folder_ / "photos/a.png", image::EncodePng(rgba, 1));
  AddPhoto("a.png");
  for (const char* name : {"b.jpg", "c.jpg"}) WriteJpegPhoto(name);
  const PhotoSet given = photos_;
  EXPECT_EQ(Make(), folder_ / "photos");
  EXPECT_FALSE(photos_.usable[0].filled);
  const fs::path white = Make("", "white");
  EXPECT_EQ(white, folder_ / "made");
  EXPECT_EQ(Pixel(white, "a.png"), (Rgb{244, 224, 204}));
  EXPECT_EQ(image::LoadRgb8(white / "a.png").data[3], 255);
  EXPECT_TRUE(photos_.usable[0].filled && photos_.usable[0].converted);
  EXPECT_FALSE(photos_.usable[1].filled || photos_.usable[1].converted);
  photos_ = given;
  EXPECT_EQ(Pixel(Make("", "black"), "a.png"), (Rgb{40, 20, 0}));
  // And found finished.
  photos_ = given;
  Make("", "black");
  EXPECT_TRUE(photos_.usable[0].filled);
}

// One photo that uses the whole range makes 16 bits of all.
TEST_F(PlainPhotosTest, SixteenBitsAreScaledAsTheDecoderDoes) {
  WriteTiff<uint16_t>("a.tif", {257, 25700, 65535}, 2);
  WriteTiff<uint16_t>("sub/b.tif", {100, 4000, 128}, 2);
  WriteTiff<uint16_t>("c.tif", {0, 129, 128}, 2);
  const fs::path root = Make();
  EXPECT_EQ(root, folder_ / "made");
  EXPECT_EQ(Pixel(root, "a.tif"), (Rgb{1, 100, 255}));
  EXPECT_EQ(Pixel(root, "sub/b.tif"), (Rgb{0, 16, 0}));
  EXPECT_EQ(Pixel(root, "c.tif"), (Rgb{0, 1, 0}));
  for (const PhotoFile& photo : photos_.usable) EXPECT_TRUE(photo.converted) << photo.name;
}

// 12 bits in 16: the brightest photo decides for all, so that the others keep their relative brightness.
TEST_F(PlainPhotosTest, TwelveBitsInSixteenAreNotBlack) {
  WriteTiff<uint16_t>("a.tif", {4095, 2048, 16}, 2);
  WriteTiff<uint16_t>("b.tif", {1000, 500, 8}, 2);
  WriteTiff<uint16_t>("c.tif", {40, 20, 0}, 2);
  const fs::path root = Make();
  EXPECT_EQ(Pixel(root, "a.tif"), (Rgb{255, 128, 1}));
  EXPECT_EQ(Pixel(root, "b.tif"), (Rgb{62, 31, 0}));
  EXPECT_EQ(Pixel(root, "c.tif"), (Rgb{2, 1, 0}));
}

TEST_F(PlainPhotosTest, TagsSayTheRangeUnlessValuesExceedIt) {
  constexpr uint16_t kMaxSampleValue = 281;
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint16_t>(name, {1000, 520, 240}, 2, {}, {{kMaxSampleValue, 2040}});
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{125, 65, 30}));
  StartAnew();
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint16_t>(name, {1000, 520, 240}, 2, {}, {{kMaxSampleValue, 300}});
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{249, 130, 60}));
}

TEST_F(PlainPhotosTest, FloatingPointAndGreyAreConverted) {
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<float>(name, {0.5F, 1.0F, -2.0F}, 2);
  EXPECT_EQ(Pixel(Make(), "b.tif"), (Rgb{128, 255, 0}));
  StartAnew();
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint16_t>(name, {1023}, 1);
  EXPECT_EQ(Pixel(Make(), "b.tif"), (Rgb{255, 255, 255}));
  StartAnew();
  // Grey and alpha.
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint8_t>(name, {77, 128}, 1, {2});
  EXPECT_EQ(Pixel(Make(), "b.tif"), (Rgb{77, 77, 77}));
}

TEST_F(PlainPhotosTest, InkBecomesLight) {
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint8_t>(name, {255, 0, 51, 51}, 5);
  // (255 - ink) (255 - black) / 255.
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{0, 204, 163}));
  StartAnew();
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint16_t>(name, {65535, 0, 13107, 13107}, 5);
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{0, 204, 163}));
}

TEST_F(PlainPhotosTest, BandsAreChosenByNumberOrName) {
  const auto write = [&] {
    StartAnew();
    for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint8_t>(name, {10, 20, 30, 40, 50}, 1, {0, 0, 0, 0});
  };
  write();
  EXPECT_EQ(Pixel(Make("3,2,1"), "a.tif"), (Rgb{30, 20, 10}));
  write();
  EXPECT_EQ(Pixel(Make("5"), "a.tif"), (Rgb{50, 50, 50}));
  write();
  const std::vector<std::string> names = {"Blue", "Green", "Red", "Red edge", "NIR"};
  for (PhotoFile& photo : photos_.usable) photo.tags.band_names = names;
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{30, 20, 10}));
  write();
  for (PhotoFile& photo : photos_.usable) photo.tags.band_names = names;
  EXPECT_EQ(Pixel(Make("nir, red-edge, GREEN"), "a.tif"), (Rgb{50, 40, 20}));
  write();
  std::string message = InputErrorOf([&] { Make(); });
  EXPECT_NE(message.find("has 5 bands without names"), std::string::npos) << message;
  EXPECT_NE(message.find("Set prepare.bands"), std::string::npos) << message;
  write();
  for (PhotoFile& photo : photos_.usable) photo.tags.band_names = names;
  message = InputErrorOf([&] { Make("6,2,1"); });
  EXPECT_NE(message.find("has no band 6"), std::string::npos) << message;
  EXPECT_NE(message.find("4 Red edge"), std::string::npos) << message;
}

// The option counts for TIFFs of four bands that are pictures already, too.
TEST_F(PlainPhotosTest, TheOptionHoldsForPicturesWithAFourthBand) {
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint8_t>(name, {10, 20, 30, 40}, 2, {0});
  EXPECT_EQ(Make(), folder_ / "photos");
  EXPECT_EQ(Pixel(Make("4,1,2"), "a.tif"), (Rgb{40, 10, 20}));
}

TEST_F(PlainPhotosTest, OtherPhotosOfTheSurveyAreThereToo) {
  WriteJpegPhoto("a.jpg");
  WriteTiff<uint16_t>("b.tif", {65535, 0, 0}, 2);
  WriteJpegPhoto("c.jpg");
  const fs::path root = Make();
  EXPECT_EQ(base::ReadFile(root / "a.jpg"), base::ReadFile(folder_ / "photos/a.jpg"));
  EXPECT_FALSE(photos_.usable[0].converted);
  EXPECT_TRUE(photos_.usable[1].converted);
}

TEST_F(PlainPhotosTest, ASecondCallFindsThemFinishedAndAChangeMakesThemAnew) {
  const auto write = [&](uint16_t red) {
    photos_ = {};
    for (const char* name : {"a.tif", "b.tif", "c.tif"}) WriteTiff<uint16_t>(name, {red, 0, 0}, 2);
  };
  write(65535);
  const fs::path root = Make();
  const auto time = fs::last_write_time(root / "a.tif");
  photos_ = {};
  for (const char* name : {"a.tif", "b.tif", "c.tif"}) AddPhoto(name);
  EXPECT_EQ(Make(), root);
  EXPECT_EQ(fs::last_write_time(root / "a.tif"), time);
  EXPECT_TRUE(photos_.usable[0].converted);
  write(4095);
  fs::last_write_time(folder_ / "photos/a.tif", fs::last_write_time(folder_ / "photos/a.tif") + std::chrono::seconds(5));
  EXPECT_EQ(Pixel(Make(), "a.tif"), (Rgb{255, 0, 0}));
}

TEST_F(PlainPhotosTest, DamagedPhotosAreLeftOutAndStaySo) {
  for (const char* name : {"a.tif", "b.tif", "c.tif", "d.tif"}) WriteTiff<uint16_t>(name, {65535, 0, 0}, 2);
  const std::string whole = base::ReadFile(folder_ / "photos/b.tif");
  base::WriteFileAtomically(folder_ / "photos/b.tif", whole.substr(0, whole.size() - 60));
  const fs::path root = Make();
  ASSERT_EQ(photos_.usable.size(), 3U);
  EXPECT_EQ(photos_.usable[1].name, "c.tif");
  EXPECT_EQ(photos_.unreadable, std::vector<std::string>{"b.tif"});
  const auto time = fs::last_write_time(root / "a.tif");
  photos_ = {};
  for (const char* name : {"a.tif", "b.tif", "c.tif", "d.tif"}) AddPhoto(name);
  Make();
  EXPECT_EQ(photos_.unreadable, std::vector<std::string>{"b.tif"});
  EXPECT_EQ(fs::last_write_time(root / "a.tif"), time);
}

TEST(WhiteLevel, IsTheSmallestUsualRangeThatHoldsAllPhotos) {
  const auto white = [](std::vector<double> largest, bool floating = false) {
    std::vector<PhotoRange> photos;
    for (const double value : largest) photos.push_back({.largest = value, .floating = floating, .bits = floating ? 32 : 16, .white = {}});
    return FindWhite(photos).value;
  };
  EXPECT_EQ(white({200.0, 100.0}), 255.0);
  EXPECT_EQ(white({900.0, 100.0}), 1023.0);
  EXPECT_EQ(white({900.0, 1500.0}), 4095.0);
  EXPECT_EQ(white({4096.0}), 4095.0);
  EXPECT_EQ(white({4097.0}), 16383.0);
  EXPECT_EQ(white({16500.0, 3.0}), 65535.0);
  EXPECT_EQ(white({1e6}), 1048575.0);
  EXPECT_EQ(white({0.9, 1.2}, true), 1.0);
  EXPECT_EQ(white({0.9, 230.0}, true), 255.0);
  EXPECT_EQ(white({0.0}), 255.0);
  // Types of 9 to 15 bits say it.
  EXPECT_EQ(FindWhite(std::vector<PhotoRange>{{.largest = 3.0, .floating = false, .bits = 12, .white = {}}}).value, 4095.0);
  // A tag in only some of the photos says nothing of the others.
  EXPECT_EQ(FindWhite(std::vector<PhotoRange>{{.largest = 900.0, .floating = false, .bits = 16, .white = 1000.0},
                                              {.largest = 900.0, .floating = false, .bits = 16, .white = {}}})
                .value,
            1023.0);
}

TEST(BandsOption, IsCheckedBeforeAnyPhoto) {
  for (const char* good : {"", "3,2,1", "red, green ,blue", "4", "NIR"}) EXPECT_NO_THROW(CheckBandsOption(good)) << good;
  for (const char* bad : {"1,2", "1,2,3,4", "1,,3", "0,1,2", "-1", ","}) EXPECT_THROW(CheckBandsOption(bad), base::UsageError) << bad;
}

}  // namespace
}  // namespace skyquilt::prepare::input
