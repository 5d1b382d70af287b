// Passes of real scenes, as pixels.
#include <gtest/gtest.h>

#include <cmath>

#include "core/base/file.h"
#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "products/camera_path.h"
#include "products/render_views.h"
#include "tests/support/temporary_folder.h"
#include "tests/viewer/engine/whole_scene.h"
#include "viewer/engine/frame_job.h"

namespace skyquilt::viewer {
namespace {

// A scene file without a project.
class SceneRenderer : public Renderer {
 public:
  SceneRenderer(const WholeScene& what, size_t batch) : batch_(batch) {
    WriteWholeScene(folder_ / "scene.h5", what);
    scene = std::make_unique<scene::Scene>(scene::Scene::Load(folder_ / "scene.h5"));
    frame = {.cones = scene->info().scales.Cones(), .min_enu = scene->info().min_enu, .max_enu = scene->info().max_enu};
    photo.model = camera::CameraModel::kOpencv;
    photo.width = 200;
    photo.height = 150;
    photo.params = {150.0, 152.0, 98.0, 77.0, -0.1, 0.02, 0.001, -0.002};
  }
  const SceneFrame* Frame(Which /*project*/) const override { return &frame; }
  std::string WhyNot(Which /*project*/) const override { return ""; }
  size_t Batch(Which /*project*/) const override { return batch_; }
  void Render(Which /*project*/, std::span<const render::Ray> rays, std::span<render::RayColor> out) override {
    scene->RenderRaysOverBackground(rays, out, appearance, threads);
  }
  products::View PhotoView(int /*photo*/, int width) const override {
    return {"photo", photo.Resized(width, width * 3 / 4), products::PoseFromAngles({2.0, -3.0, 7.0}, 10.0, -50.0, 4.0)};
  }
  FieldAccess Access() override { return {}; }

  // All passes, smallest first.
  std::vector<RenderedPass> Passes(const ViewRequest& view) {
    std::vector<RenderedPass> passes;
    FrameJob job(view, *this);
    while (!job.Done()) {
      if (std::optional<RenderedPass> pass = job.Step(*this)) passes.push_back(std::move(*pass));
    }
    return passes;
  }

  std::unique_ptr<scene::Scene> scene;
  SceneFrame frame;
  scene::Appearance appearance;
  camera::Camera photo;
  base::ThreadPool threads{2};

 private:
  TemporaryFolder folder_;
  size_t batch_;
};

ViewRequest LookingDown(double z, int width, int height) {
  ViewRequest view;
  view.eye_enu = {2.5, 2.5, z};
  view.cam_from_enu = products::PoseFromAngles(view.eye_enu, 0.0, -90.0, 0.0).rotation;
  view.width = width;
  view.height = height;
  return view;
}

void ExpectSamePicture(SceneRenderer& renderer, const RenderedPass& pass, const camera::Camera& camera, const geo::Rigid3d& pose) {
  const std::vector<render::RayColor> colors = renderer.scene->RenderCamera(camera, pose, renderer.appearance, renderer.threads);
  EXPECT_EQ(pass.rgb, products::ColorImage(colors, camera.width, camera.height).data);
  const Eigen::Vector3d ahead = pose.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  size_t surface = 0, sky = 0;
  for (size_t i = 0; i < colors.size(); ++i) {
    ASSERT_EQ(std::isnan(pass.depth_m[i]), std::isnan(colors[i].depth_median)) << i;
    if (std::isnan(pass.depth_m[i])) {
      ++sky;
      continue;
    }
    ++surface;
    const auto width = static_cast<size_t>(camera.width);
    const Eigen::Vector2d pixel(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
    const double cosine = (pose.rotation.conjugate() * camera.RayFromImg(pixel)).normalized().dot(ahead);
    ASSERT_NEAR(pass.depth_m[i], static_cast<double>(colors[i].depth_median) * cosine, 1e-5);
  }
  // Otherwise the test would show little.
  EXPECT_GT(surface, 20U);
  EXPECT_GT(sky, 20U);
}

TEST(ExactFrame, TheLastPassIsTheRenderedCameraPathBitByBit) {
  for (const bool cones : {false, true}) {
    SceneRenderer renderer({.cones = cones}, 777);
    renderer.appearance.log_gain = {0.3F, -0.2F, 0.0F};
    const TemporaryFolder folder;
    base::WriteFileAtomically(folder / "path.json", R"([{"position_enu": [-3.0, 1.5, 6.25], "yaw": 75, "pitch": -40, "roll": 3, "fov": 83.5}])");
    const int width = 101, height = 67;
    const products::View wanted = products::LoadCameraPath(folder / "path.json", renderer.scene->info(), width, height).front();
    ViewRequest view;
    view.eye_enu = {-3.0, 1.5, 6.25};
    view.cam_from_enu = wanted.cam_from_enu.rotation;
    view.width = width;
    view.height = height;
    const double degree = std::acos(-1.0) / 180.0;
    view.fovy_deg = 2.0 * std::atan(std::tan(0.5 * 83.5 * degree) * height / width) / degree;
    const std::vector<RenderedPass> passes = renderer.Passes(view);
    ASSERT_EQ(passes.size(), 3U);
    EXPECT_EQ(passes[0].header.width, 26);
    EXPECT_EQ(passes[0].header.height, 17);
    EXPECT_EQ(passes[1].header.width, 51);
    EXPECT_EQ(passes[1].header.format, ColorFormat::kJpeg);
    EXPECT_EQ(passes[2].header.format, ColorFormat::kPng);
    ExpectSamePicture(renderer, passes[2], wanted.camera, wanted.cam_from_enu);
  }
}

TEST(ExactFrame, APhotosViewHasItsCamera) {
  SceneRenderer renderer({.cones = true}, 500);
  ViewRequest view;
  view.photo = 0;
  view.width = 80;
  const std::vector<RenderedPass> passes = renderer.Passes(view);
  ASSERT_FALSE(passes.empty());
  const RenderedPass& last = passes.back();
  const products::View photo = renderer.PhotoView(0, 80);
  EXPECT_TRUE(last.header.photo);
  EXPECT_EQ(last.header.height, 60);
  EXPECT_LT((last.header.eye_enu - Eigen::Vector3d(2.0, -3.0, 7.0)).norm(), 1e-9);
  EXPECT_NEAR(last.header.fovy_deg_or_height_m, 2.0 * std::atan(30.0 / photo.camera.FocalY()) * 180.0 / std::acos(-1.0), 1e-9);
  ExpectSamePicture(renderer, last, photo.camera, photo.cam_from_enu);
}

TEST(ExactFrame, DepthIsMeasuredAlongTheOpticalAxisFromTheEye) {
  SceneRenderer renderer({.solid = true}, 300);
  ViewRequest view = LookingDown(24.0, 64, 48);
  view.fovy_deg = 16.0;
  const RenderedPass perspective = renderer.Passes(view).back();
  view.orthographic = true;
  view.view_height_m = 7.0;
  const RenderedPass above = renderer.Passes(view).back();
  view.eye_enu.z() = 1.0;  // inside: rays start above all the same
  const RenderedPass inside = renderer.Passes(view).back();
  int seen = 0;
  for (size_t y = 0; y < 48; ++y) {
    for (size_t x = 0; x < 64; ++x) {
      const size_t i = y * 64 + x;
      // Where the block is in the orthographic picture, with half a pixel to spare.
      const double east = 2.5 + (static_cast<double>(x) + 0.5 - 32.0) * 7.0 / 48.0, north = 2.5 - (static_cast<double>(y) + 0.5 - 24.0) * 7.0 / 48.0;
      const bool on_block = east > 0.1 && east < 4.9 && north > 0.1 && north < 4.9;
      const bool off_block = east < -0.1 || east > 5.1 || north < -0.1 || north > 5.1;
      if (on_block) {
        ++seen;
        EXPECT_NEAR(above.depth_m[i], 20.0, 0.1) << east << " " << north;
        EXPECT_NEAR(inside.depth_m[i], -3.0, 0.1) << east << " " << north;
      }
      if (off_block) {
        EXPECT_TRUE(std::isnan(above.depth_m[i])) << east << " " << north;
      }
      // The top is flat, so z is the same in all directions.
      if (!std::isnan(perspective.depth_m[i]) && x > 20 && x < 44 && y > 12 && y < 36) {
        EXPECT_NEAR(perspective.depth_m[i], 20.0, 0.1);
      }
    }
  }
  EXPECT_GT(seen, 900);
  EXPECT_FALSE(std::isnan(perspective.depth_m[24 * 64 + 32]));
}

TEST(ExactFrame, PassesShowTheSameHeightOfTheScene) {
  const SceneFrame frame{.min_enu = {0, 0, 0}, .max_enu = {5, 5, 4}};
  ViewRequest view = LookingDown(30.0, 1000, 563);
  std::vector<render::Ray> top(1), bottom(1);
  for (const PassSize& size : PassSizes(1000, 563)) {
    const PassRays rays(view, size, frame);
    const std::vector<size_t> first = {static_cast<size_t>(size.width / 2)},
                              last = {static_cast<size_t>(size.width / 2) + static_cast<size_t>(size.width * (size.height - 1))};
    rays.Make(first, top);
    rays.Make(last, bottom);
    const double angle = std::acos(top[0].direction_enu.dot(bottom[0].direction_enu)) * 180.0 / std::acos(-1.0);
    // From the first row's centre to the last row's.
    const double focal = 0.5 * size.height / std::tan(30.0 * std::acos(-1.0) / 180.0);
    EXPECT_NEAR(angle, 2.0 * std::atan(0.5 * (size.height - 1) / focal) * 180.0 / std::acos(-1.0), 0.01);
  }
}

TEST(ExactFrame, SizesOfPasses) {
  const auto widths = [](int width, int height) {
    std::vector<int> all;
    for (const PassSize& size : PassSizes(width, height)) all.push_back(size.width);
    return all;
  };
  EXPECT_EQ(widths(1000, 563), (std::vector<int>{250, 500, 1000}));
  EXPECT_EQ(PassSizes(1000, 563)[0].height, 141);
  EXPECT_EQ(widths(61, 61), (std::vector<int>{16, 31, 61}));
  EXPECT_EQ(widths(60, 60), (std::vector<int>{30, 60}));
  EXPECT_EQ(widths(2048, 16), (std::vector<int>{2048}));
  EXPECT_EQ(widths(16, 16), (std::vector<int>{16}));
}

TEST(ExactFrame, AnEarlierSceneIsSeenFromTheSamePlace) {
  SceneFrame main{.min_enu = {-50, -50, 0}, .max_enu = {50, 50, 30}}, before = main;
  before.scene_from_main = geo::Rigid3d{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.1, 0.2, 1.0).normalized())), {100.0, -20.0, 5.0}};
  const std::vector<size_t> pixels = {0, 77, 1500, 3000};
  std::vector<render::Ray> here(4), there(4);
  for (const bool orthographic : {false, true}) {
    ViewRequest view = LookingDown(80.0, 64, 48);
    view.cam_from_enu = products::PoseFromAngles(view.eye_enu, 33.0, -41.0, 5.0).rotation;
    view.orthographic = orthographic;
    view.view_height_m = 40.0;
    const PassRays in_main(view, {64, 48}, main), in_before(view, {64, 48}, before);
    in_main.Make(pixels, here);
    in_before.Make(pixels, there);
    for (size_t i = 0; i < pixels.size(); ++i) {
      const Eigen::Vector3d direction = before.scene_from_main->rotation * here[i].direction_enu;
      EXPECT_LT((there[i].direction_enu - direction).norm(), 1e-12);
      const Eigen::Vector3d apart = there[i].origin_enu - *before.scene_from_main * here[i].origin_enu;
      EXPECT_LT(apart.cross(direction).norm(), 1e-9);  // on the same line
      if (!orthographic) {
        EXPECT_LT(apart.norm(), 1e-9);
      }
    }
    // The header's pose is that of the request.
    EXPECT_EQ(in_before.eye_enu(), view.eye_enu);
    EXPECT_EQ(in_before.cam_from_enu().coeffs(), view.cam_from_enu.coeffs());
    // The same surface has the same depth, wherever the rays begin.
    render::RayColor color;
    const double t = 60.0;
    color.depth_median = static_cast<float>(t);
    const double z = here[1].direction_enu.dot(here[1].origin_enu + t * here[1].direction_enu - view.eye_enu);
    if (orthographic) {
      EXPECT_NEAR(in_main.Depth(here[1], color), z, 1e-4);
    }
  }
}

}  // namespace
}  // namespace skyquilt::viewer
