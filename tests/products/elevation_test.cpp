#include "products/elevation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/image.h"
#include "products/camera_path.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::products {
namespace {

// An opaque white wall with black lines, 0.1 m wide, at every metre across and up, 24 m wide and 10 m high, and a red one 6 m behind it that is
// wider.
struct LinedWall {
  double azimuth_deg = 205.0;
  Eigen::Vector3d foot{30.0, -12.0, 2.0};  // of the middle

  Eigen::Vector3d Normal() const {
    const double azimuth = azimuth_deg * std::numbers::pi / 180.0;
    return {std::sin(azimuth), std::cos(azimuth), 0.0};
  }
  Eigen::Vector3d Right() const { return Eigen::Vector3d::UnitZ().cross(Normal()); }
  static bool OnLine(double x) { return std::abs(x - std::round(x)) <= 0.05; }

  RayCaster Caster() const {
    return [*this](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
      for (size_t i = 0; i < rays.size(); ++i) {
        const render::Ray& ray = rays[i];
        out[i].depth = out[i].depth_median = std::numeric_limits<float>::quiet_NaN();
        for (const bool front : {true, false}) {
          const double t = (foot - ray.origin_enu - (front ? 0.0 : 6.0) * Normal()).dot(Normal()) / ray.direction_enu.dot(Normal());
          if (!(t >= ray.t_near && t <= ray.t_far)) continue;
          const Eigen::Vector3d x = ray.origin_enu + t * ray.direction_enu - foot;
          const double across = x.dot(Right());
          if (std::abs(across) > (front ? 12.0 : 40.0) || x.z() < 0.0 || x.z() > 10.0) continue;
          const bool line = OnLine(across) || OnLine(x.z());
          out[i].opacity = 1.0F;
          out[i].depth = out[i].depth_median = static_cast<float>(t);
          for (float& c : out[i].rgb_srgb) c = front && !line ? 1.0F : 0.0F;
          if (!front) out[i].rgb_srgb[0] = 1.0F;
          break;
        }
      }
    };
  }

  scene::SceneInfo Info() const {
    scene::SceneInfo info;
    info.gsd_m = 0.03;
    info.min_enu = foot - Eigen::Vector3d(20.0, 20.0, 1.0);
    info.max_enu = foot + Eigen::Vector3d(20.0, 20.0, 11.0);
    return info;
  }

  ElevationPlane Plane(double resolution_m) const {
    ElevationPlane plane;
    plane.name = "wall";
    plane.middle_enu = foot + Eigen::Vector3d(0.0, 0.0, 5.0);
    plane.azimuth_deg = azimuth_deg;
    plane.width_m = 26.0;
    plane.height_m = 11.0;
    plane.front_m = 3.0;
    plane.behind_m = 1.5;
    plane.resolution_m = resolution_m;
    return plane;
  }
};

// Middles of the runs of dark pixels.
std::vector<double> Lines(const std::vector<bool>& dark) {
  std::vector<double> middles;
  for (size_t begin = 0; begin < dark.size(); ++begin) {
    if (!dark[begin]) continue;
    size_t end = begin;
    while (end < dark.size() && dark[end]) ++end;
    middles.push_back(0.5 * static_cast<double>(begin + end));
    begin = end;
  }
  return middles;
}

Eigen::Vector3d Triple(const nlohmann::json& json) {
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

TEST(Elevation, HasStraightLinesInTheRightPixels) {
  const TemporaryFolder folder;
  for (const double resolution : {0.025, 0.037}) {
    LinedWall wall;
    const Elevation made = WriteElevation(wall.Plane(resolution), wall.Info(), wall.Caster(), ProductOptions{}, folder.path(), true);
    const image::Image8 picture = image::LoadRgb8(made.picture);
    const image::Image8 seen = image::LoadAlphaMask(made.picture);
    ASSERT_EQ(picture.width, made.width);
    EXPECT_EQ(made.width, static_cast<int>(std::ceil(26.0 / resolution - 1e-3)));
    const auto json = base::ParseJson(base::ReadFile(folder / "wall.json"));
    ASSERT_EQ(json["resolution"], resolution);
    const Eigen::Vector3d origin = Triple(json["origin_enu"]), right = Triple(json["right_enu"]), down = Triple(json["down_enu"]);
    const auto place = [&](double column, double row) -> Eigen::Vector3d { return origin + resolution * (column * right + row * down); };
    // A row between two level lines, and a column between two plumb ones.
    const int row = static_cast<int>((origin.z() - wall.foot.z() - 4.5) / resolution);
    const int column = static_cast<int>(((wall.foot - origin).dot(right) + 0.5) / resolution);
    std::vector<bool> across, up;
    for (int x = 0; x < picture.width; ++x) across.push_back(*seen.At(x, row) != 0 && picture.At(x, row)[1] < 128);
    for (int y = 0; y < picture.height; ++y) up.push_back(*seen.At(column, y) != 0 && picture.At(column, y)[1] < 128);
    const std::vector<double> plumb = Lines(across), level = Lines(up);
    ASSERT_EQ(plumb.size(), 25U);
    ASSERT_EQ(level.size(), 11U);
    for (size_t i = 1; i + 1 < plumb.size(); ++i) {  // half of the outermost ones lies beside the wall
      EXPECT_NEAR((place(plumb[i], row) - wall.foot).dot(wall.Right()), static_cast<double>(i) - 12.0, resolution);
    }
    for (size_t i = 1; i + 1 < level.size(); ++i) EXPECT_NEAR(place(column, level[i]).z() - wall.foot.z(), 10.0 - static_cast<double>(i), resolution);
    // Nothing red: what is behind the wall does not show beside it.
    EXPECT_EQ(*seen.At(1, row), 0);
    EXPECT_NEAR(made.shown, 24.0 * 10.0 / (26.0 * 11.0), 0.01);
    const image::ImageF depth = image::LoadFloatTiff(folder / "wall_depth.tiff");
    EXPECT_NEAR(static_cast<double>(*depth.At(column, row)), 0.0, 1e-3);
    EXPECT_TRUE(std::isnan(*depth.At(1, row)));
  }
}

TEST(Elevation, SaysItsScale) {
  const TemporaryFolder folder;
  LinedWall wall;
  scene::SceneInfo info = wall.Info();
  const auto description = [&] {
    WriteElevation(wall.Plane(0.1), info, wall.Caster(), ProductOptions{}, folder.path(), false);
    return base::ParseJson(base::ReadFile(folder / "wall.json"));
  };
  EXPECT_EQ(description()["unit"], "unit of the reconstruction");
  EXPECT_FALSE(description().contains("depth"));
  EXPECT_FALSE(description().contains("enu_at"));
  info.georeferenced = true;
  EXPECT_EQ(description()["unit"], "m");
  EXPECT_TRUE(description().contains("enu_at"));
  // The bar of 5 m lies below the picture of 260 x 110 pixels.
  const image::Image8 preview = image::LoadRgb8(folder / "wall_preview.png");
  ASSERT_EQ(preview.width, 260);
  ASSERT_GT(preview.height, 110);
  int longest = 0;
  for (int y = 110; y < preview.height; ++y) {
    int dark = 0;
    for (int x = 0; x < preview.width; ++x) dark += preview.At(x, y)[0] < 64 ? 1 : 0;
    longest = std::max(longest, dark);
  }
  EXPECT_EQ(longest, 50);
}

TEST(StatedElevation, ReadsPlaceDirectionAndSize) {
  LinedWall wall;
  const scene::SceneInfo info = wall.Info();
  ProductOptions options;
  const ElevationPlane plane = StatedElevation("30,-12,7,180,24,10", info, nullptr, options, 0);
  EXPECT_TRUE(plane.Normal().isApprox(Eigen::Vector3d(0, -1, 0), 1e-12)) << "a wall that looks south";
  EXPECT_TRUE(plane.Right().isApprox(Eigen::Vector3d(1, 0, 0), 1e-12));
  EXPECT_TRUE(plane.TopLeft().isApprox(Eigen::Vector3d(18, -12, 12), 1e-9));
  EXPECT_DOUBLE_EQ(plane.front_m, 3.0);
  EXPECT_DOUBLE_EQ(plane.behind_m, 1.5);
  EXPECT_DOUBLE_EQ(plane.resolution_m, 0.02) << "0.03 m, rounded";
  const ElevationPlane whole = StatedElevation("0,-12,7,180", info, nullptr, options, 0);
  EXPECT_TRUE(whole.middle_enu.isApprox(Eigen::Vector3d(30, -12, 7), 1e-9)) << "covers the box";
  EXPECT_NEAR(whole.width_m, 40.0, 1e-9);
  EXPECT_NEAR(whole.height_m, 12.0, 1e-9);
  for (const char* text : {"", "1,2,3", "1,2,3,4,5", "1,2,x,4", "1,2,3,4,-5,6", "1,2,3,4,5,6,7", "1,2,3,nan"}) {
    EXPECT_THROW(StatedElevation(text, info, nullptr, options, 0), base::UsageError) << text;
  }
  options.max_pixels = 1e4;
  EXPECT_LE(24.0 * 10.0 / std::pow(StatedElevation("30,-12,7,180,24,10", info, nullptr, options, 0).resolution_m, 2), 1.1e4);
  options.resolution_m = 0.01;
  EXPECT_NE(UsageErrorOf([&] { StatedElevation("30,-12,7,180,24,10", info, nullptr, options, 0); }).find("set it to at least"), std::string::npos);
}

// As fine as the nearest photo is trained with, and nothing nearer to it than to the wall.
TEST(StatedElevation, FollowsThePhotosBeforeIt) {
  LinedWall wall;
  survey::Survey survey;
  survey.cameras = {PinholeCamera(4000, 3000, 90.0)};  // 2000 pixels focal length
  for (const double distance : {4.0, 40.0}) {
    survey::Photo photo;
    photo.cam_from_enu = PoseLookingAt({30.0, -12.0 - distance, 7.0}, {30.0, -12.0, 7.0});
    survey.photos.push_back(photo);
  }
  const ElevationPlane fine = StatedElevation("30,-12,7,180,4,3", wall.Info(), &survey, {}, 0);
  EXPECT_DOUBLE_EQ(fine.resolution_m, 0.002);
  EXPECT_DOUBLE_EQ(StatedElevation("30,-12,7,180,4,3", wall.Info(), &survey, {}, 400).resolution_m, 0.02);
  EXPECT_NEAR(fine.front_m, 0.9, 1e-9);
  EXPECT_NEAR(StatedElevation("30,-12,7,180,20,10", wall.Info(), &survey, {}, 0).front_m, 2.0, 1e-9) << "half of the way to the nearest photo";
}

}  // namespace
}  // namespace skyquilt::products
