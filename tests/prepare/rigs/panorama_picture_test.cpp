// Views of pictures whose light is a formula of the direction.
#include "prepare/rigs/panorama_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/image/srgb.h"
#include "prepare/rigs/panorama_views.h"

namespace skyquilt::prepare::rigs {
namespace {

constexpr int kWidth = 1024, kHeight = 512;

camera::Camera CameraOfView(int width, double fov_deg) {
  const double focal_px = ViewFocal(width, fov_deg);
  return {camera::CameraModel::kPinhole, width, width, {focal_px, focal_px, 0.5 * width, 0.5 * width}};
}

// Smooth all around, also over seam and poles.
Eigen::Vector3d LightOf(const Eigen::Vector3d& ray) {
  return {0.5 + 0.3 * ray.x(), 0.5 + 0.3 * std::sin(4.0 * ray.y()) * ray.z(), 0.4 + 0.2 * ray.x() * ray.z() + 0.15 * ray.y()};
}

uint8_t Stored(double light) {
  return static_cast<uint8_t>(std::lround(255.0F * image::SrgbFromLinear(static_cast<float>(light))));
}

template <typename Light>
image::Image8 PictureOf(const SphereArea& area, const Light& light) {
  image::Image8 picture(area.width, area.height, 3);
  for (int y = 0; y < area.height; ++y) {
    for (int x = 0; x < area.width; ++x) {
      const Eigen::Vector3d rgb = light(area.sphere.RayFromImg({x + area.left + 0.5, y + area.top + 0.5}));
      for (Eigen::Index c = 0; c < 3; ++c) picture.At(x, y)[c] = Stored(rgb[c]);
    }
  }
  return picture;
}

const SphereArea kWhole{.sphere = {kWidth, kHeight}, .left = 0, .top = 0, .width = kWidth, .height = kHeight};

TEST(PanoramaPicture, ViewsShowTheLightOfTheirDirections) {
  base::ThreadPool threads(2);
  const image::Image8 picture = PictureOf(kWhole, LightOf);
  const camera::Camera camera = CameraOfView(160, 90.0);
  // The seam is behind, the poles are above and below.
  for (const PanoramaView& view : LayOutViews(4, {0.0, -35.0, -90.0, 90.0})) {
    const image::Image8 shown = RenderView(picture, kWhole, camera, view.cam_from_pano, threads);
    int largest = 0;
    for (int y = 0; y < 160; ++y) {
      for (int x = 0; x < 160; ++x) {
        const Eigen::Vector3d expected = LightOf(PanoramaRay(camera, view.cam_from_pano, {x + 0.5, y + 0.5}));
        for (Eigen::Index c = 0; c < 3; ++c) largest = std::max(largest, std::abs(shown.At(x, y)[c] - Stored(expected[c])));
      }
    }
    EXPECT_LE(largest, 1) << view.prefix;
  }
}

// Stripes finer than the view's pixels must become their mean light, not a moire.
TEST(PanoramaPicture, SmallViewsAndPolesDoNotAlias) {
  base::ThreadPool threads(2);
  image::Image8 stripes(kWidth, kHeight, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) std::fill_n(stripes.At(x, y), 3, static_cast<uint8_t>(x % 2 == 0 ? 255 : 0));
  }
  const int mean = Stored(0.5);
  const camera::Camera camera = CameraOfView(24, 90.0);
  const image::Image8 level = RenderView(stripes, kWhole, camera, LayOutViews(4, {0.0})[1].cam_from_pano, threads);
  for (int y = 8; y < 16; ++y) {
    for (int x = 8; x < 16; ++x) EXPECT_NEAR(level.At(x, y)[0], mean, 14) << x << " " << y;
  }
  // Near the pole, a pixel covers hundreds of the stripes.
  const image::Image8 down = RenderView(stripes, kWhole, CameraOfView(60, 60.0), LayOutViews(4, {-90.0})[0].cam_from_pano, threads);
  double sum = 0.0;
  for (int y = 25; y < 35; ++y) {
    for (int x = 25; x < 35; ++x) sum += down.At(x, y)[0];
  }
  EXPECT_NEAR(sum / 100.0, mean, 10.0);
}

TEST(PanoramaPicture, IsTheSameForAnyNumberOfThreads) {
  base::ThreadPool one(1), three(3);
  const image::Image8 picture = PictureOf(kWhole, LightOf);
  const camera::Camera camera = CameraOfView(64, 100.0);
  const Eigen::Quaterniond view = LayOutViews(4, {-35.0})[2].cam_from_pano;
  EXPECT_EQ(RenderView(picture, kWhole, camera, view, one).data, RenderView(picture, kWhole, camera, view, three).data);
}

TEST(PanoramaPicture, TheConeBelowIsMasked) {
  base::ThreadPool threads(2);
  const camera::Camera camera = CameraOfView(200, 90.0);
  for (const PanoramaView& view : LayOutViews(4, {-35.0, -90.0})) {
    const image::Image8 mask = MaskOfView({}, kWhole, camera, view.cam_from_pano, 25.0, threads);
    ASSERT_FALSE(mask.Empty());
    for (int y = 0; y < 200; ++y) {
      for (int x = 0; x < 200; ++x) {
        const double from_nadir_deg =
            std::acos(std::clamp(PanoramaRay(camera, view.cam_from_pano, {x + 0.5, y + 0.5}).y(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
        if (std::abs(from_nadir_deg - 25.0) > 1e-6) EXPECT_EQ(*mask.At(x, y), from_nadir_deg < 25.0 ? 0 : 255) << x << " " << y;
      }
    }
  }
  EXPECT_TRUE(MaskOfView({}, kWhole, camera, LayOutViews(4, {35.0})[0].cam_from_pano, 25.0, threads).Empty());
  EXPECT_TRUE(MaskOfView({}, kWhole, camera, LayOutViews(4, {-90.0})[0].cam_from_pano, 0.0, threads).Empty());
}

TEST(PanoramaPicture, ThePanoramasOwnMaskIsCutToo) {
  base::ThreadPool threads(2);
  image::Image8 own(kWidth, kHeight, 1, 255);
  for (int y = 0; y < kHeight; ++y) std::fill_n(own.At(kWidth / 2, y), kWidth / 2, uint8_t{0});  // the right half
  const camera::Camera camera = CameraOfView(100, 90.0);
  const std::vector<PanoramaView> views = LayOutViews(4, {0.0});
  const image::Image8 ahead = MaskOfView(own, kWhole, camera, views[0].cam_from_pano, 0.0, threads);
  EXPECT_EQ(*ahead.At(20, 50), 255);
  EXPECT_EQ(*ahead.At(80, 50), 0);
  const image::Image8 right = MaskOfView(own, kWhole, camera, views[1].cam_from_pano, 0.0, threads);
  EXPECT_TRUE(std::all_of(right.data.begin(), right.data.end(), [](uint8_t value) { return value == 0; }));
}

// A part of the sphere, as phones make: the rest is black and masked.
TEST(PanoramaPicture, PartsOfASphereAreWhereTheirTagsSay) {
  base::ThreadPool threads(2);
  input::PhotoFile photo{.name = "p.jpg", .width = 300, .height = 200};
  photo.tags.panorama = survey::PanoramaTags{
      .heading_deg = {}, .pitch_deg = {}, .roll_deg = {}, .full_width = 2048, .full_height = 1024, .left = 724, .top = 312, .area_width = 600};
  const SphereArea area = AreaOf(photo);
  EXPECT_EQ(area.sphere.width, 1024);
  EXPECT_EQ(area.left, 362);
  EXPECT_EQ(area.top, 156);
  EXPECT_FALSE(area.IsWhole());
  const image::Image8 picture = PictureOf(area, LightOf);
  const camera::Camera camera = CameraOfView(100, 120.0);
  const Eigen::Quaterniond ahead = LayOutViews(4, {0.0})[0].cam_from_pano;
  const image::Image8 shown = RenderView(picture, area, camera, ahead, threads);
  const image::Image8 mask = MaskOfView({}, area, camera, ahead, 0.0, threads);
  EXPECT_EQ(*mask.At(50, 50), 255);
  EXPECT_EQ(*mask.At(2, 50), 0);
  EXPECT_EQ(shown.At(2, 50)[0], 0);
  const Eigen::Vector3d expected = LightOf(PanoramaRay(camera, ahead, {50.5, 50.5}));
  EXPECT_NEAR(shown.At(50, 50)[0], Stored(expected.x()), 1);
}

TEST(PanoramaPicture, AreaWithoutUsableTagsIsTheWholeAround) {
  input::PhotoFile photo{.name = "p.jpg", .width = 2000, .height = 1000};
  EXPECT_TRUE(AreaOf(photo).IsWhole());
  // Tags of another picture.
  photo.tags.panorama = survey::PanoramaTags{
      .heading_deg = {}, .pitch_deg = {}, .roll_deg = {}, .full_width = 1000, .full_height = 500, .left = 950, .top = 0, .area_width = 100};
  EXPECT_TRUE(AreaOf(photo).IsWhole());
  photo.tags.panorama.reset();
  photo.height = 600;
  EXPECT_EQ(AreaOf(photo).top, 200);
  EXPECT_EQ(AreaOf(photo).sphere.height, 1000);
}

}  // namespace
}  // namespace skyquilt::prepare::rigs
