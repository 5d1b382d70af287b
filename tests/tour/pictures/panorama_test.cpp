// Panoramas against what is known of their scenes, and against perspective pictures of the same field.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "products/camera_path.h"
#include "tests/tour/pictures/sample_fields.h"
#include "tour/pictures/picture_file.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {
namespace {

void Ignore(int64_t /*rays*/) {}

RenderedPicture Rendered(const PictureRequest& request, const PictureField& field) {
  return RenderPicture(request, field, field.caster(request.exposure), Ignore);
}

std::vector<float> DepthsOf(const StoredPicture& picture) {
  const size_t n = static_cast<size_t>(picture.depth_width) * static_cast<size_t>(picture.depth_height);
  return image::UnpackDepths(picture.depth, n, picture.range, image::DepthScale::kInverse);
}

// The direction of an image position; written apart from the program's, which makes it from tables.
Eigen::Vector3d Direction(double x, double y, int width) {
  const double azimuth = (x / width - 0.5) * 2.0 * std::numbers::pi, elevation = (0.25 - y / width) * 2.0 * std::numbers::pi;
  return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation), std::sin(elevation)};
}

Eigen::Vector2d PositionOf(const Eigen::Vector3d& direction, int width) {
  const double azimuth = std::atan2(direction.x(), direction.y()), elevation = std::asin(direction.z() / direction.norm());
  return {(azimuth / (2.0 * std::numbers::pi) + 0.5) * width, (0.25 - elevation / (2.0 * std::numbers::pi)) * width};
}

TEST(Panorama, DepthIsTheDistanceToTheSurface) {
  constexpr int kWidth = 128;
  const CountedField counted;
  const Eigen::Vector3d eye(0.0, -5.0, 18.0);
  const StoredPicture picture = Encode(Rendered(PanoramaAt(eye, kWidth, "normal"), counted.field));
  ASSERT_EQ(picture.depth_width, kWidth / 2);
  ASSERT_EQ(picture.depth_height, kWidth / 4);
  const std::vector<float> depths = DepthsOf(picture);
  const products::AnalyticScene scene;
  const auto near_m = static_cast<double>(picture.range.near_m);
  EXPECT_NEAR(near_m, 10.0, 0.05) << "the house's wall";
  const double half_step = 0.5 / 65534.0 / near_m;
  int surface = 0, sky = 0;
  for (int j = 0; j < picture.depth_height; ++j) {
    for (int i = 0; i < picture.depth_width; ++i) {
      const auto d = static_cast<double>(depths[static_cast<size_t>(j * picture.depth_width + i)]);
      const double expected = scene.Distance({.origin_enu = eye, .direction_enu = Direction(2 * i + 0.5, 2 * j + 0.5, kWidth)});
      if (std::isinf(expected)) {
        EXPECT_TRUE(std::isnan(d)) << i << " " << j;
        ++sky;
      } else {
        EXPECT_NEAR(1.0 / d, 1.0 / std::max(expected, near_m), half_step + 1e-6 / expected) << i << " " << j;
        ++surface;
      }
    }
  }
  EXPECT_GT(surface, 500);
  EXPECT_GT(sky, 500);
}

TEST(Panorama, SizeOfBatchesDoesNotMatter) {
  CountedField counted;
  const PictureRequest request = PanoramaAt({0.0, 0.0, 30.0}, 64, "normal");
  const RenderedPicture some = Rendered(request, counted.field);
  counted.field.batch_rays = 37;
  const RenderedPicture few = Rendered(request, counted.field);
  EXPECT_EQ(some.color.data, few.color.data);
  EXPECT_EQ(Encode(some).depth, Encode(few).depth);
}

TEST(Panorama, WithoutASurfaceHasNoDepth) {
  CountedField counted;
  counted.field.caster = [](const std::string&) -> products::RayCaster {
    return [](std::span<const render::Ray>, std::span<render::RayColor> out) {
      for (render::RayColor& color : out) color.depth_median = std::nanf("");
    };
  };
  const StoredPicture picture = Encode(Rendered(PanoramaAt(Eigen::Vector3d::Zero(), 16, "normal"), counted.field));
  EXPECT_EQ(picture.depth_width, 8);
  EXPECT_TRUE(picture.depth.empty());
  EXPECT_EQ(picture.range.far_m, 0.0F);
}

// With steps that begin at the speck, 290 m and 300 m would be the same.
TEST(Panorama, ASpeckBeforeTheEyeDoesNotSpoilTheDepths) {
  constexpr int kWidth = 128;
  RenderedPicture rendered;
  rendered.color = image::Image8(kWidth, kWidth / 2, 3);
  rendered.depth_m.assign(kWidth * kWidth / 2, 300.0F);
  for (size_t i = 0; i < rendered.depth_m.size(); i += 4) rendered.depth_m[i] = 290.0F;
  rendered.depth_m[20 * kWidth + 20] = 0.001F;
  const StoredPicture picture = Encode(rendered);
  const std::vector<float> depths = DepthsOf(picture);
  for (size_t i = 0; i < depths.size(); ++i) EXPECT_NEAR(depths[i], i % 2 == 0 ? 290.0F : 300.0F, 0.01F) << i;
}

// Surfaces that fill more of the picture are kept, as far as numbers allow.
TEST(Panorama, WhatIsNearIsKept) {
  RenderedPicture rendered;
  rendered.color = image::Image8(128, 64, 3);
  rendered.depth_m.assign(128 * 64, 1000.0F);
  std::fill_n(rendered.depth_m.begin(), 128 * 4, 0.5F);
  EXPECT_FLOAT_EQ(DepthsOf(Encode(rendered))[0], 0.5F);
  std::fill_n(rendered.depth_m.begin(), 128 * 4, 1e-5F);
  EXPECT_FLOAT_EQ(DepthsOf(Encode(rendered))[0], 0.1F) << "a ten-thousandth of the farthest";
}

// Looks into six directions with an ordinary camera and finds the same in the panorama.
void ExpectSameAsPerspective(const SceneField& scene, const Eigen::Vector3d& eye) {
  constexpr int kWidth = 512;
  const RenderedPicture panorama = Rendered(PanoramaAt(eye, kWidth, "normal"), scene.field);
  int compared = 0, surface = 0, alike = 0;
  for (const auto& [yaw, pitch] : {std::pair{0.0, 0.0}, {90.0, 0.0}, {180.0, 0.0}, {270.0, -30.0}, {0.0, -90.0}, {45.0, 80.0}}) {
    // The pixel in the middle has the angle of the panorama's.
    constexpr int kSize = 120;
    const double fov_deg = 2.0 * std::atan(0.5 * kSize * 2.0 * std::numbers::pi / kWidth) * 180.0 / std::numbers::pi;
    const camera::Camera camera = products::PinholeCamera(kSize, kSize, fov_deg);
    const geo::Rigid3d pose = products::PoseFromAngles(eye, yaw, pitch, 0.0);
    base::ThreadPool threads(2);
    const std::vector<render::RayColor> colors = scene.scene->RenderCamera(camera, pose, {}, threads);
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) {
        const Eigen::Vector2d at = PositionOf(pose.rotation.conjugate() * camera.RayFromImg({x + 0.5, y + 0.5}), kWidth) - Eigen::Vector2d(0.5, 0.5);
        const int column = static_cast<int>(std::floor(at.x())), row = static_cast<int>(std::floor(at.y()));
        if (row < 0 || row + 1 >= kWidth / 2) continue;
        const double u = at.x() - column, v = at.y() - row;
        double rgb[3] = {0, 0, 0}, inverse = 0.0, least = 1e9, most = 0.0;
        bool edge = false;
        for (int corner = 0; corner < 4; ++corner) {
          const int cx = (column + corner % 2 + kWidth) % kWidth, cy = row + corner / 2;
          const double share = (corner % 2 == 1 ? u : 1.0 - u) * (corner / 2 == 1 ? v : 1.0 - v);
          for (int c = 0; c < 3; ++c) rgb[c] += share * panorama.color.At(cx, cy)[c];
          const auto d = static_cast<double>(panorama.depth_m[static_cast<size_t>(cy * kWidth + cx)]);
          edge = edge || std::isnan(d);
          inverse += share / d;
          least = std::min(least, d);
          most = std::max(most, d);
        }
        const render::RayColor& expected = colors[static_cast<size_t>(y * kSize + x)];
        ++compared;
        double worst = 0.0;
        for (int c = 0; c < 3; ++c)
          worst = std::max(worst, std::abs(rgb[c] - 255.0 * static_cast<double>(std::clamp(expected.rgb_srgb[c], 0.0F, 1.0F))));
        if (worst <= 4.0) ++alike;
        if (edge || std::isnan(expected.depth_median) || most > 1.05 * least) continue;
        ++surface;
        EXPECT_NEAR(1.0 / inverse, static_cast<double>(expected.depth_median), 0.02 * static_cast<double>(expected.depth_median))
            << yaw << " " << pitch << ": " << x << " " << y;
      }
    }
  }
  EXPECT_GT(compared, 6 * 110 * 110);
  EXPECT_GT(surface, 5000);
  // Others are at the block's silhouette, where interpolated pixels mix both sides.
  EXPECT_GT(alike, compared * 97 / 100);
}

TEST(Panorama, ShowsWhatPerspectivePicturesShow) {
  ExpectSameAsPerspective(SceneField({.solid = true}), {1.0, 2.0, 7.0});
}

TEST(Panorama, ShowsWhatPerspectivePicturesShowWithCones) {
  ExpectSameAsPerspective(SceneField({.solid = true, .cones = true}), {-3.0, 2.0, 3.0});
}

}  // namespace
}  // namespace skyquilt::tour
