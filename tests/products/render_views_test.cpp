#include "products/render_views.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/camera/pixel_pitch.h"
#include "core/image/normal_image.h"
#include "core/image/video_writer.h"
#include "products/camera_path.h"
#include "tests/products/analytic_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/in_temporary_folder.h"
#include "tests/support/video_facts.h"

namespace skyquilt::products {
namespace {

using RenderViewsTest = InTemporaryFolder;

TEST_F(RenderViewsTest, DepthRunsAlongTheRay) {
  const AnalyticScene scene;
  View view;
  view.name = "nadir";
  view.camera = PinholeCamera(64, 48, 60.0);
  view.cam_from_enu = PoseFromAngles({-40.0, 0.0, 105.0}, 0.0, -90.0, 0.0);
  base::ThreadPool threads(2);
  const RenderStats stats = RenderViews(RendererOf(scene.Caster()), {view}, folder_.path(), {}, threads);
  EXPECT_EQ(stats.views, 1);
  EXPECT_EQ(stats.rays, 64 * 48);
  const image::ImageF depth = image::LoadFloatTiff(folder_.path() / "nadir_depth.tiff");
  ASSERT_EQ(depth.width, 64);
  const double f = view.camera.FocalX();
  for (const auto& [x, y] : {std::pair{0, 0}, {31, 23}, {10, 40}}) {
    const Eigen::Vector2d offset = (Eigen::Vector2d(x + 0.5, y + 0.5) - Eigen::Vector2d(32, 24)) / f;
    EXPECT_NEAR(static_cast<double>(*depth.At(x, y)), 100.0 * std::sqrt(1.0 + offset.squaredNorm()), 1e-3);
  }
  const image::Image8 picture = image::LoadRgb8(folder_.path() / "nadir.png");
  EXPECT_EQ(picture.At(0, 24)[1], 255) << "green in the west";
  EXPECT_EQ(picture.At(63, 0)[0], 255) << "red in the east";
  // The house's west wall begins 50 m east of the camera and 100 m below it: 27.7 px right of the centre.
  EXPECT_EQ(picture.At(58, 24)[0], 255) << "ground";
  EXPECT_EQ(picture.At(61, 24)[2], 255) << "wall";
}

TEST_F(RenderViewsTest, RaysAreTheConesOfTheirPixels) {
  View view;
  view.camera = PinholeCamera(64, 48, 60.0);
  view.cam_from_enu = PoseFromAngles({-40.0, 0.0, 105.0}, 0.0, -90.0, 0.0);
  std::vector<render::Ray> seen;
  RendererOf([&](std::span<const render::Ray> rays, std::span<render::RayColor>) { seen.insert(seen.end(), rays.begin(), rays.end()); })(view);
  ASSERT_EQ(seen.size(), size_t{64} * 48);
  const camera::PixelPitch pitch(view.camera);
  for (size_t i = 0; i < seen.size(); ++i) {
    const size_t row = i / 64, column = i % 64;
    const Eigen::Vector2d pixel(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    EXPECT_EQ(seen[i].pixel_pitch, static_cast<float>(pitch.At(pixel)));
    EXPECT_EQ(seen[i].pixel_width, 0.0F);
  }
  EXPECT_NEAR(static_cast<double>(seen[24 * 64 + 32].pixel_pitch), 1.0 / view.camera.FocalX(), 2e-3 / view.camera.FocalX());
}

TEST_F(RenderViewsTest, SkyIsBlackWithoutDepth) {
  View view;
  view.name = "up";
  view.camera = PinholeCamera(8, 6, 60.0);
  view.cam_from_enu = PoseFromAngles({0.0, 0.0, 105.0}, 0.0, 80.0, 0.0);
  base::ThreadPool threads(2);
  RenderViews(RendererOf(AnalyticScene{}.Caster()), {view}, folder_.path(), {}, threads);
  EXPECT_TRUE(std::isnan(*image::LoadFloatTiff(folder_.path() / "up_depth.tiff").At(3, 3)));
  EXPECT_EQ(image::LoadRgb8(folder_.path() / "up.png").At(3, 3)[0], 0);
}

// Ground, roof and the wall that the camera sees, in a camera that looks down at an angle.
TEST_F(RenderViewsTest, NormalsPointOutOfGroundRoofAndWall) {
  const AnalyticScene scene;
  View view;
  view.name = "oblique";
  view.camera = PinholeCamera(120, 90, 60.0);
  view.cam_from_enu = PoseFromAngles({-40.0, -5.0, 60.0}, 90.0, -40.0, 0.0);
  base::ThreadPool threads(2);
  RenderViews(RendererOf(scene.Caster()), {view}, folder_.path(), {.depth = false, .normals = NormalKind::kDepth}, threads);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "oblique_depth.tiff"));
  const image::ImageF normals = image::LoadNormals(folder_.path() / "oblique_normals.png");
  ASSERT_EQ(normals.width, 120);
  const auto normal_at = [&](const Eigen::Vector3d& x_in_enu) {
    const std::optional<Eigen::Vector2d> pixel = view.camera.ImgFromCam(view.cam_from_enu * x_in_enu);
    const float* n = normals.At(static_cast<int>(pixel->x()), static_cast<int>(pixel->y()));
    return Eigen::Vector3f(n[0], n[1], n[2]);
  };
  EXPECT_LT((normal_at({-5.0, -5.0, 5.0}) - Eigen::Vector3f(0, 0, 1)).norm(), 2e-3F) << "ground";
  EXPECT_LT((normal_at({22.0, -5.0, 25.0}) - Eigen::Vector3f(0, 0, 1)).norm(), 2e-3F) << "roof";
  EXPECT_LT((normal_at({10.0, -5.0, 15.0}) - Eigen::Vector3f(-1, 0, 0)).norm(), 2e-3F) << "wall towards the west";
}

TEST_F(RenderViewsTest, NormalsHaveNames) {
  EXPECT_EQ(NormalKindNamed("depth"), NormalKind::kDepth);
  EXPECT_EQ(NormalKindNamed("density"), NormalKind::kDensity);
  EXPECT_EQ(NormalKindNamed("predicted"), NormalKind::kPredicted);
  EXPECT_THROW(NormalKindNamed("guessed"), base::UsageError);
}

TEST_F(RenderViewsTest, PredictedNormalsNeedAHead) {
  scene::SceneInfo info = AnalyticScene{}.Info({41.0, 2.0, 0.0}, true);
  EXPECT_NO_THROW(RequireNormals(NormalKind::kDensity, info));
  EXPECT_THROW(RequireNormals(NormalKind::kPredicted, info), base::UsageError);
  info.normal_head = true;
  EXPECT_NO_THROW(RequireNormals(NormalKind::kPredicted, info));
}

// Rays that return their normals: pixels that are not half opaque have none.
TEST_F(RenderViewsTest, RenderedNormalsAreThoseOfTheRays) {
  const RayCaster caster = [](std::span<const render::Ray> rays, std::span<render::RayColor> out) {
    for (size_t i = 0; i < rays.size(); ++i) {
      out[i].depth_median = i == 0 ? std::nanf("") : 3.0F;
      out[i].density_normal[i == 1 ? 0 : 2] = i == 2 ? 0.0F : 1.0F;
      out[i].predicted_normal[1] = -1.0F;
    }
  };
  View view;
  view.name = "v";
  view.camera = PinholeCamera(4, 2, 60.0);
  base::ThreadPool threads(1);
  RenderViews(RendererOf(caster), {view}, folder_.path(), {.depth = true, .normals = NormalKind::kDensity}, threads);
  const image::ImageF density = image::LoadNormals(folder_.path() / "v_normals.png");
  EXPECT_TRUE(std::isnan(*density.At(0, 0))) << "not half opaque";
  EXPECT_NEAR(density.At(1, 0)[0], 1.0F, 1e-4F);
  EXPECT_TRUE(std::isnan(*density.At(2, 0))) << "no normal";
  EXPECT_NEAR(density.At(3, 0)[2], 1.0F, 1e-4F);
  RenderViews(RendererOf(caster), {view}, folder_.path(), {.depth = true, .normals = NormalKind::kPredicted}, threads);
  EXPECT_NEAR(image::LoadNormals(folder_.path() / "v_normals.png").At(2, 0)[1], -1.0F, 1e-4F);
}

TEST(RenderVideo, HasOneFramePerView) {
  if (!image::CanWriteVideos()) GTEST_SKIP() << "the program ffmpeg is not installed";
  const TemporaryFolder folder;
  const AnalyticScene scene;
  ProductOptions options;
  options.video_seconds = 1.0;
  options.video_width = 160;
  options.video_height = 90;
  const std::vector<View> views = BuiltInPath(scene.Info({41.0, 2.0, 0.0}, true), options);
  const std::filesystem::path file = folder.path() / "video.mp4";
  const RenderStats stats = RenderVideo(RendererOf(scene.Caster()), views, options.video_fps, file);
  EXPECT_EQ(stats.rays, 12 * 160 * 90);
  const VideoFacts facts = Inspect(file);
  EXPECT_EQ(facts.frames, 12);
  EXPECT_EQ(facts.width, 160);
  EXPECT_EQ(facts.height, 90);
  EXPECT_EQ(facts.rate, "12/1");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << "nothing else is left";
}

TEST_F(RenderViewsTest, StopsWhenCancelled) {
  View view;
  view.name = "x";
  view.camera = PinholeCamera(8, 6, 60.0);
  base::ThreadPool threads(1);
  ExpectStopsWhenAsked([&] { RenderViews(RendererOf(AnalyticScene{}.Caster()), {view}, folder_.path(), {}, threads); });
}

TEST(ProductOptions, RefuseWhatCannotBe) {
  ProductOptions options;
  options.Check();
  options.video_width = 481;
  EXPECT_THROW(options.Check(), base::UsageError);
  options = {};
  options.video_path = "dive";
  EXPECT_THROW(options.Check(), base::UsageError);
  options = {};
  options.min_opacity = std::nan("");
  EXPECT_THROW(options.Check(), base::UsageError);
}

}  // namespace
}  // namespace skyquilt::products
