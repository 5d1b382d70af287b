#include "core/image/pixel_cache.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/progress.h"
#include "core/image/image.h"
#include "tests/core/image/raw_files.h"
#include "tests/support/error_of.h"
#include "tests/support/limited_file_size.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::image {
namespace {

class PixelCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    base::Progress::SetQuiet(true);
    // Ten photos of two sizes; the third has a mask with a hole.
    for (int i = 0; i < 10; ++i) {
      const std::filesystem::path photo = folder_.path() / ("photo" + std::to_string(i) + ".png");
      Image8 image = i == 7 ? Pattern(60, 30) : Pattern(80, 61);
      image.data[0] = static_cast<uint8_t>(i);
      SavePng(image, photo);
      sources_.push_back({photo, {}});
    }
    Image8 mask(80, 61, 1, 255);
    *mask.At(41, 31) = 0;
    SavePng(mask, folder_.path() / "mask.png");
    sources_[2].mask = folder_.path() / "mask.png";
  }

  PixelCache Open(int image_width) { return PixelCache::Open(file_, sources_, image_width, threads_); }
  ino_t Inode() const {
    struct stat status {};
    return stat(file_.c_str(), &status) == 0 ? status.st_ino : 0;
  }
  bool PartialLeft() const { return std::filesystem::exists(file_.string() + ".tmp"); }

  TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "pixels.cache";
  std::vector<PixelSource> sources_;
  base::ThreadPool threads_{2};
};

TEST_F(PixelCacheTest, HoldsTheLoadedAndResizedPhotos) {
  const PixelCache cache = Open(40);
  ASSERT_EQ(cache.size(), sources_.size());
  for (size_t i = 0; i < sources_.size(); ++i) {
    const Image8 photo = LoadRgb8(sources_[i].photo);
    const Image8 expected = Resize(photo, 40, ScaledHeight(photo.width, photo.height, 40));
    ASSERT_EQ(cache.Width(i), expected.width);
    ASSERT_EQ(cache.Height(i), expected.height);
    EXPECT_TRUE(std::ranges::equal(cache.Rgb(i), expected.data)) << i;
    EXPECT_EQ(cache.Mask(i).empty(), i != 2);
  }
  const Image8 expected_mask = ResizeMask(LoadMask(sources_[2].mask), 40, cache.Height(2));
  EXPECT_TRUE(std::ranges::equal(cache.Mask(2), expected_mask.data));
  EXPECT_GT(std::ranges::count(cache.Mask(2), 0), 0);
  EXPECT_FALSE(PartialLeft());
}

TEST_F(PixelCacheTest, SinglePixelsAreTheSameMappedAndStreamed) {
  base::ThreadPool threads(2);
  PixelCache cache = PixelCache::Open(folder_.path() / "cache.bin", sources_, 40, threads);
  for (const bool streaming : {false, true}) {
    cache.Stream(streaming);
    int ignored = 0;
    for (const size_t photo : {size_t{0}, size_t{2}, size_t{7}}) {
      const auto rgb = cache.Rgb(photo);
      const auto mask = cache.Mask(photo);
      const PixelCache::Photo copy = cache.Copy(photo);
      EXPECT_TRUE(std::equal(copy.rgb.begin(), copy.rgb.end(), rgb.begin(), rgb.end()));
      EXPECT_TRUE(std::equal(copy.mask.begin(), copy.mask.end(), mask.begin(), mask.end()));
      for (size_t pixel = 0; pixel < rgb.size() / 3; ++pixel) {
        uint8_t one[3] = {1, 2, 3};
        const bool counts = cache.Pixel(photo, pixel, one);
        EXPECT_EQ(counts, mask.empty() || mask[pixel] != 0);
        ignored += counts ? 0 : 1;
        for (size_t c = 0; c < 3 && counts; ++c) EXPECT_EQ(one[c], rgb[3 * pixel + c]);
      }
    }
    EXPECT_GT(ignored, 0);
  }
}

// As a rank on another machine opens it, which may see other times of the photos, or other photos.
TEST_F(PixelCacheTest, OpensByItsIdentityWithoutThePhotos) {
  const PixelCache built = Open(40);
  for (const PixelSource& source : sources_) std::filesystem::remove(source.photo);
  const PixelCache opened = PixelCache::OpenBuilt(file_, built.identity());
  ASSERT_EQ(opened.size(), built.size());
  EXPECT_TRUE(std::ranges::equal(opened.Rgb(4), built.Rgb(4)));
  EXPECT_EQ(opened.identity(), built.identity());
  EXPECT_THROW(PixelCache::OpenBuilt(file_, "another"), base::InputError);
  EXPECT_THROW(PixelCache::OpenBuilt(folder_.path() / "nowhere", built.identity()), base::InputError);
}

TEST_F(PixelCacheTest, NeverEnlarges) {
  for (const int width : {0, -1, 60, 5000}) {
    const PixelCache cache = Open(width);
    EXPECT_EQ(cache.Width(7), 60) << width;
    EXPECT_EQ(cache.Height(7), 30) << width;
    EXPECT_TRUE(std::ranges::equal(cache.Rgb(7), LoadRgb8(sources_[7].photo).data)) << width;
  }
}

TEST_F(PixelCacheTest, IsBuiltOnceAndRebuiltWhenSomethingChanged) {
  Open(40);
  const ino_t first = Inode();
  Open(40);
  EXPECT_EQ(Inode(), first);
  Open(20);
  const ino_t second = Inode();
  EXPECT_NE(second, first);

  std::filesystem::last_write_time(sources_[0].photo, std::filesystem::last_write_time(sources_[0].photo) + std::chrono::seconds(5));
  Open(20);
  const ino_t third = Inode();
  EXPECT_NE(third, second);

  sources_.pop_back();
  const PixelCache fewer = Open(20);
  EXPECT_EQ(fewer.size(), 9U);
  EXPECT_NE(Inode(), third);
}

TEST_F(PixelCacheTest, IsRebuiltWhenItsFileIsDamaged) {
  Open(40);
  const std::string good = base::ReadFile(file_);
  for (const std::string& bad : {good.substr(0, good.size() - 1), good.substr(0, 10), std::string(), good + "x", "X" + good.substr(1)}) {
    WriteBytes(file_, bad);
    const PixelCache cache = Open(40);
    EXPECT_EQ(cache.size(), sources_.size());
    EXPECT_EQ(base::ReadFile(file_), good);
  }
}

TEST_F(PixelCacheTest, NamesEveryUnreadablePhoto) {
  WriteBytes(sources_[1].photo, "text");
  WriteBytes(sources_[8].photo, "more text");
  const std::string message = InputErrorOf([&] { Open(40); });
  EXPECT_NE(message.find("2 of 10"), std::string::npos) << message;
  EXPECT_NE(message.find("photo1.png: is not an image"), std::string::npos) << message;
  EXPECT_NE(message.find("photo8.png: is not an image"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_FALSE(PartialLeft());
}

TEST_F(PixelCacheTest, NamesEveryMissingPhoto) {
  std::filesystem::remove(sources_[3].photo);
  std::filesystem::remove(sources_[4].photo);
  const std::string message = InputErrorOf([&] { Open(40); });
  EXPECT_NE(message.find("photo3.png"), std::string::npos) << message;
  EXPECT_NE(message.find("photo4.png"), std::string::npos) << message;
}

TEST_F(PixelCacheTest, RefusesAMaskOfAnotherSize) {
  SavePng(Image8(80, 60, 1, 255), sources_[2].mask);
  const std::string message = InputErrorOf([&] { Open(40); });
  EXPECT_NE(message.find("mask of 80x60 pixels for a photo of 80x61"), std::string::npos) << message;
}

TEST_F(PixelCacheTest, MayBeEmpty) {
  sources_.clear();
  EXPECT_EQ(Open(40).size(), 0U);
}

TEST_F(PixelCacheTest, StopsOnCancelWithoutLeavingAFile) {
  ExpectStopsWhenAsked([&] { Open(40); });
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_FALSE(PartialLeft());
}

TEST_F(PixelCacheTest, RemovesThePartialFileWhenTheDiskIsFull) {
  const std::string message = InputErrorOf([&] {
    const LimitedFileSize limit(20000);
    Open(40);
  });
  EXPECT_NE(message.find("cannot be written"), std::string::npos) << message;
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_FALSE(PartialLeft());
}

TEST_F(PixelCacheTest, ServesProcessesThatOpenItAtOnce) {
  std::vector<pid_t> children;
  for (int i = 0; i < 4; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      int status = 1;
      try {
        base::ThreadPool threads(1);
        const PixelCache cache = PixelCache::Open(file_, sources_, 40, threads);
        status = cache.size() == sources_.size() && cache.Rgb(9)[3] > 0 ? 0 : 2;
      } catch (...) {
      }
      _exit(status);
    }
    children.push_back(child);
  }
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
  EXPECT_EQ(Open(40).size(), sources_.size());
  EXPECT_FALSE(PartialLeft());
}

}  // namespace
}  // namespace skyquilt::image
