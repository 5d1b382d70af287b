#include "masks/segmenter.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/base/file.h"
#include "tests/support/error_of.h"
#include "tests/support/made_onnx.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::masks {
namespace {

using image::Image8;

// Red where it is brighter than green by more than 0.4.
const std::vector<std::vector<float>> kFindsRed = {{0, 0, 0, 0}, {1, -1, 0, -0.4F}};
constexpr const char* kClasses = "classes = [\"other\", \"red\"]\nignore = [\"red\"]\n";

class SegmenterTest : public testing::Test {
 protected:
  Segmenter Make(const std::string& model, const std::string& config) const {
    base::WriteFileAtomically(folder_ / "red.onnx", model);
    base::WriteFileAtomically(folder_ / "red.toml", config);
    return {folder_ / "red.onnx", folder_ / "red.toml"};
  }
  static std::string Size(int width, int height) {
    return "input_width = " + std::to_string(width) + "\ninput_height = " + std::to_string(height) + "\n";
  }
  TemporaryFolder folder_;
};

Image8 GreyWithRed(int width, int height, const std::vector<std::pair<int, int>>& red) {
  Image8 photo(width, height, 3, 120);
  for (const auto& [x, y] : red) {
    photo.At(x, y)[0] = 250;
    photo.At(x, y)[1] = photo.At(x, y)[2] = 10;
  }
  return photo;
}

std::vector<std::pair<int, int>> Ignored(const Image8& mask) {
  std::vector<std::pair<int, int>> pixels;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (*mask.At(x, y) == 0) pixels.emplace_back(x, y);
    }
  }
  return pixels;
}

TEST_F(SegmenterTest, IgnoresThePixelsOfItsClasses) {
  Segmenter segmenter = Make(onnx::ColorModel(kFindsRed, 8, 12), Size(12, 8) + kClasses);
  const std::vector<std::pair<int, int>> red = {{0, 0}, {5, 3}, {11, 7}};
  const Image8 mask = segmenter.Mask(GreyWithRed(12, 8, red));
  EXPECT_EQ(mask.width, 12);
  EXPECT_EQ(mask.height, 8);
  EXPECT_EQ(Ignored(mask), red);
}

// Every pixel of a photo of any size is looked at once, where it is.
TEST_F(SegmenterTest, TilesCoverPhotosOfAnySize) {
  for (const int overlap : {0, 3}) {
    Segmenter segmenter =
        Make(onnx::ColorModel(kFindsRed, -1, -2), Size(10, 8) + kClasses + "photo_width = 37\noverlap = " + std::to_string(overlap));
    for (const auto& [width, height] : {std::pair{37, 23}, {37, 8}, {6, 31}, {1, 1}, {10, 9}}) {
      std::vector<std::pair<int, int>> red;
      for (int y = 0; y < height; ++y) {
        for (int x = (y * 7) % 5; x < width; x += 5) red.emplace_back(x, y);
      }
      EXPECT_EQ(Ignored(segmenter.Mask(GreyWithRed(width, height, red))), red) << width << " x " << height;
    }
  }
}

TEST_F(SegmenterTest, PhotosAreReducedToTheirWidth) {
  Segmenter segmenter = Make(onnx::ColorModel(kFindsRed, 8, 8), Size(8, 8) + kClasses);
  const Image8 mask = segmenter.Mask(GreyWithRed(
      32, 16,
      {{8, 4}, {9, 4}, {10, 4}, {11, 4}, {8, 5}, {9, 5}, {10, 5}, {11, 5}, {8, 6}, {9, 6}, {10, 6}, {11, 6}, {8, 7}, {9, 7}, {10, 7}, {11, 7}}));
  EXPECT_EQ(mask.width, 8);
  EXPECT_EQ(mask.height, 4);
  EXPECT_EQ(Ignored(mask), (std::vector<std::pair<int, int>>{{2, 1}}));
}

TEST_F(SegmenterTest, ScaleMeanStdAndOrderAreThoseOfTheConfiguration) {
  // value * 0.01 - mean) / std: 250 -> (2.5 - 0.5) / 2 = 1 in the network's first channel, which is blue.
  const std::string model = onnx::ColorModel({{0, 0, 0, 0.99F}, {1, 0, 0, 0}}, 4, 4);
  Segmenter segmenter = Make(model, Size(4, 4) + kClasses + "scale = 0.01\nmean = [0.5, 9, 9]\nstd = [2, 1, 1]\nchannels = \"bgr\"\n");
  Image8 photo(4, 4, 3, 0);
  photo.At(1, 2)[2] = 250;
  photo.At(2, 2)[2] = 247;
  photo.At(3, 2)[0] = 255;
  EXPECT_EQ(Ignored(segmenter.Mask(photo)), (std::vector<std::pair<int, int>>{{1, 2}}));
}

TEST_F(SegmenterTest, ASingleClassIsWhereItsProbabilityReachesTheThreshold) {
  const std::string model = onnx::ColorModel({{1, 0, 0, 0}}, 4, 4);
  const std::string config = Size(4, 4) + "classes = [\"red\"]\nignore = [\"red\"]\nthreshold = 0.75\n";
  Segmenter segmenter = Make(model, config);
  Image8 photo(4, 4, 3, 190);
  photo.At(2, 1)[0] = 192;  // 192 / 255 = 0.753
  EXPECT_EQ(Ignored(segmenter.Mask(photo)), (std::vector<std::pair<int, int>>{{2, 1}}));
}

TEST_F(SegmenterTest, KeysTellNetworksAndConfigurationsApart) {
  const std::string model = onnx::ColorModel(kFindsRed, 4, 4), config = Size(4, 4) + kClasses;
  const std::string key = Make(model, config).Key();
  EXPECT_EQ(Make(model, config).Key(), key);
  EXPECT_NE(Make(model, config + "dilate_px = 1\n").Key(), key);
  EXPECT_NE(Make(onnx::ColorModel({{0, 0, 0, 0}, {1, -1, 0, -0.3F}}, 4, 4), config).Key(), key);
}

TEST_F(SegmenterTest, NetworksThatDoNotFitAreRefusedWithARemedy) {
  const std::string model = onnx::ColorModel(kFindsRed, 4, 4), config = Size(4, 4) + kClasses;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"", config},
      {"no network", config},
      {model.substr(0, model.size() - 40), config},
      {model, Size(12, 8) + kClasses},                                               // another input
      {onnx::ColorModel({{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}}, 4, 4), config},  // three classes instead of two
      {onnx::Model(onnx::Text(1, onnx::Node("Sub", {"a", "b"}, "c")) + onnx::Text(2, "g") + onnx::Text(11, onnx::Value("a", {1, 3, 4, 4})) +
                   onnx::Text(11, onnx::Value("b", {1, 3, 4, 4})) + onnx::Text(12, onnx::Value("c", {1, 3, 4, 4}))),
       config},  // two inputs
  };
  for (size_t i = 0; i < cases.size(); ++i) {
    const std::string error = InputErrorOf([&] { Make(cases[i].first, cases[i].second); });
    EXPECT_NE(error.find("red.onnx"), std::string::npos) << i << error;
    EXPECT_NE(error.find("Give a network"), std::string::npos) << i << error;
  }
  Segmenter endless = Make(onnx::ColorModel({{0, 0, 0, 0}, {3e38F, 3e38F, 3e38F, 0}}, 4, 4), config + "scale = 100\n");
  const std::string error = InputErrorOf([&] { endless.Mask(Image8(4, 4, 3, 200)); });
  EXPECT_NE(error.find("not finite"), std::string::npos) << error;
}

RC_GTEST_PROP(GrowIgnored, IgnoresAllWithinTheRadiusAndNothingElse, (uint32_t bits)) {
  const int width = *rc::gen::inRange(1, 14), height = *rc::gen::inRange(1, 14), radius = *rc::gen::inRange(0, 6);
  Image8 mask(width, height, 1, 255);
  for (size_t i = 0; i < mask.data.size(); ++i) mask.data[i] = ((bits * 2654435761U + i * 40503U) >> 7U) % 23 == 0 ? 0 : 255;
  const Image8 grown = GrowIgnored(mask, radius);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      bool near = false;
      for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) near = near || (*mask.At(u, v) == 0 && (u - x) * (u - x) + (v - y) * (v - y) <= radius * radius);
      }
      RC_ASSERT((*grown.At(x, y) == 0) == near);
    }
  }
}

}  // namespace
}  // namespace skyquilt::masks
