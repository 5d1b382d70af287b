#include <gtest/gtest.h>

#include <iomanip>
#include <sstream>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "products/camera_path.h"
#include "products/render_views.h"
#include "tests/tour/pictures/sample_fields.h"
#include "tour/pictures/make_pictures.h"
#include "tour/pictures/picture_file.h"

namespace skyquilt::tour {
namespace {

// The file that `skyquilt render --path` writes for a camera path with this pose, byte for byte.
void ExpectWhatRenderWrites(const SceneField& scene, const std::string& exposure) {
  constexpr int kWidth = 90, kHeight = 50;
  constexpr double kFovy_deg = 41.7;
  std::ostringstream path;
  path << std::setprecision(17) << R"([{"position_enu": [1.25, -2.0, 6.5], "yaw": 12.5, "pitch": -38, "roll": 3, "name": "stop", "fov": )"
       << products::FovAcrossWidth(kFovy_deg, kWidth, kHeight) << "}]";
  const std::vector<products::View> views = products::ParseCameraPath(path.str(), "path.json", scene.scene->info(), kWidth, kHeight);
  base::ThreadPool threads(3);
  const TemporaryFolder renders;
  const scene::Appearance appearance = products::AppearanceOf(exposure, scene.scene->info());
  products::RenderViews(products::RendererOf(*scene.scene, appearance, threads), views, renders.path(), {.depth = false, .normals = {}}, threads);

  const TemporaryFolder work;
  const PictureRequest still = StillAt({1.25, -2.0, 6.5}, views[0].cam_from_enu.rotation, kFovy_deg, kWidth, kHeight, exposure);
  const PictureFiles result = MakePictures({&still, 1}, scene.field, work.path());
  const StoredPicture picture = OpenPicture(result.files.at(0));
  EXPECT_EQ(picture.png, base::ReadFile(renders / "stop.png"));
}

TEST(Still, IsWhatRenderWrites) {
  const SceneField points({.density_bias = 1.0});
  ExpectWhatRenderWrites(points, "normal");
  ExpectWhatRenderWrites(points, ExposureText(-0.7, "normal"));
  ExpectWhatRenderWrites(SceneField({.density_bias = 1.0, .cones = true}), "normal");
}

// A level camera 25 m above the ground, looking straight down: all of the ground is as deep, however slanted the ray.
TEST(Still, DepthIsAlongTheOpticalAxis) {
  CountedField counted;
  const TemporaryFolder work;
  const PictureRequest still = StillAt({-40.0, 30.0, 30.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), 60.0, 40, 30, "normal");
  const StoredPicture picture = OpenPicture(MakePictures({&still, 1}, counted.field, work.path()).files.at(0));
  ASSERT_EQ(picture.depth_width, 20);
  ASSERT_EQ(picture.depth_height, 15);
  for (const float depth : image::UnpackDepths(picture.depth, 300, picture.range, image::DepthScale::kInverse)) EXPECT_NEAR(depth, 25.0F, 1e-3F);
}

TEST(Still, ExposureOfAStopCountsBeforeThatOfTheTour) {
  EXPECT_EQ(ExposureText({}, "DJI_0007.JPG"), "DJI_0007.JPG");
  EXPECT_EQ(products::ExposureStops(ExposureText(0.1, "normal")), 0.1);
  EXPECT_EQ(products::ExposureStops(ExposureText(-10.0, "normal")), -10.0);
}

TEST(Still, UnknownExposureIsRefusedBeforeAnythingIsRendered) {
  const SceneField scene({.solid = true});
  const TemporaryFolder work;
  std::vector<PictureRequest> requests(2, PanoramaAt({2.0, 2.0, 6.0}, 16, "normal"));
  requests[1].exposure = "no such photo";
  EXPECT_THROW(MakePictures(requests, scene.field, work.path()), base::UsageError);
  EXPECT_TRUE(std::filesystem::is_empty(work.path()));
  EXPECT_EQ(scene.scene->statistics().rays, 0);
}

}  // namespace
}  // namespace skyquilt::tour
