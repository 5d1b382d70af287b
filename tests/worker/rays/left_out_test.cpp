// No ray shows a pixel of the tiles that are left out: pixels of the left-out tiles are black, all others white.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "core/base/random.h"
#include "core/image/image.h"
#include "tests/support/nadir_photo.h"
#include "tests/support/temporary_folder.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::worker {
namespace {

constexpr int kWidthOfLeftOut = 160, kHeightOfLeftOut = 128;

class LeftOutTest : public ::testing::Test {
 protected:
  LeftOutTest() {
    survey_.cameras = {{camera::CameraModel::kPinhole, kWidthOfLeftOut, kHeightOfLeftOut, {80.0, 80.0, 80.0, 64.0}}};
    std::vector<image::PixelSource> sources;
    for (size_t i = 0; i < 2; ++i) {
      const survey::Photo photo = NadirPhoto({20.0 * static_cast<double>(i), 0.0, 50.0}, "p" + std::to_string(i) + ".png");
      image::Image8 picture(kWidthOfLeftOut, kHeightOfLeftOut, 3, 255);
      for (int y = 0; y < kHeightOfLeftOut; ++y) {
        for (int x = 0; x < kWidthOfLeftOut; ++x) {
          if (tiles_.At(i, x, y)) std::fill_n(picture.At(x, y), 3, uint8_t{0});
        }
      }
      image::SavePng(picture, folder_ / photo.name);
      sources.push_back({folder_ / photo.name, {}});
      survey_.photos.push_back(photo);
    }
    base::ThreadPool threads(1);
    pixels_ = image::PixelCache::Open(folder_ / "pixels.bin", sources, 0, threads);
    source_ = std::make_unique<RaySource>(survey_, pixels_, response_);
    source_->SetTiles(TrainingTiles(survey_, {0, 1}), {}, 0.0);
  }

  // Darkest colour among many rays of squares of one size.
  float Darkest(int level) {
    std::vector<double> shares(kPyramidLevels, 0.0);
    shares[static_cast<size_t>(level)] = 1.0;
    const PhotoPyramid pyramid(shares, {}, 0.0, 0.0);
    base::Random random(4);
    float darkest = 1.0F;
    for (int i = 0; i < 4000; ++i) {
      PixelRay rays[4];
      const int n = source_->DrawPatch(random, pyramid, 4, rays);
      for (int k = 0; k < n; ++k) darkest = std::min(darkest, rays[k].target_srgb[0]);
    }
    return darkest;
  }

  const trust::LeftOutTiles tiles_{0.2};
  TemporaryFolder folder_;
  survey::Survey survey_;
  image::PixelCache pixels_;
  brightness::Response response_ = brightness::Response::Neutral(2, 1);
  std::unique_ptr<RaySource> source_;
};

TEST_F(LeftOutTest, PixelsOfAllSizesAreDrawnUntilTheyAreLeftOut) {
  for (int level = 0; level < kPyramidLevels; ++level) EXPECT_LT(Darkest(level), 0.05F) << level;
  source_->SetLeftOut(tiles_);
  for (int level = 0; level < kPyramidLevels; ++level) EXPECT_GT(Darkest(level), 0.999F) << level;
}

}  // namespace
}  // namespace skyquilt::worker
