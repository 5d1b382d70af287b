#include "surface/views/depth_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surface/views/view_rendering.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

DepthLimits Limits() {
  DepthLimits limits;
  limits.max_spread_m = 1.0;
  limits.max_step_m = 2.0;
  limits.min_enu = {-1000.0, -1000.0, -5.0};
  limits.max_enu = {1000.0, 1000.0, 50.0};
  return limits;
}

// A camera that is tilted by this angle from looking down, 60 m above the ground.
ViewPose Tilted(double degrees, int width = 41, int height = 31, double focal = 60.0) {
  ViewPose pose;
  pose.width = width;
  pose.height = height;
  pose.focal_px = focal;
  pose.cx = 0.5 * width;
  pose.cy = 0.5 * height;
  const geo::Rigid3d down = LookingDown({0.0, 0.0, 60.0});
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(-degrees * std::numbers::pi / 180.0, Eigen::Vector3d::UnitX()));
  pose.cam_from_enu = {turn * down.rotation, turn * down.translation};
  return pose;
}

RenderedView Render(const ViewPose& pose, AnalyticScene& scene, const DepthLimits& limits = Limits()) {
  base::ThreadPool threads(2);
  return RenderView(pose, scene.Caster(), limits, threads, [](int64_t) {});
}

TEST(RenderView, DepthAndCosineOfAPlaneAreExact) {
  for (const double tilt : {0.0, 30.0, 55.0}) {
    AnalyticScene scene;
    scene.has_house = false;
    const ViewPose pose = Tilted(tilt);
    const RenderedView view = Render(pose, scene);
    for (int y = 0; y < pose.height; ++y) {
      for (int x = 0; x < pose.width; ++x) {
        const auto i = static_cast<size_t>(y * pose.width + x);
        const Eigen::Vector3d direction = pose.DirectionAt(x + 0.5, y + 0.5);
        const double cosine = -direction.z();
        if (cosine < 0.18) continue;  // near the largest angle
        ASSERT_NEAR(static_cast<double>(view.depth_m[i]), 60.0 / cosine, 1e-3) << tilt << " at " << x << ", " << y;
        EXPECT_NEAR(view.cosine[i], 255.0 * cosine, 1.0) << tilt << " at " << x << ", " << y;
      }
    }
  }
}

TEST(RenderView, DropsWhatIsSeenAtAFlatAngle) {
  AnalyticScene scene;
  scene.has_house = false;
  const ViewPose pose = Tilted(75.0);
  const RenderedView view = Render(pose, scene);
  for (size_t i = 0; i < view.depth_m.size(); ++i) {
    const double cosine = -pose.DirectionAt(static_cast<double>(i % 41) + 0.5, static_cast<double>(i / 41) + 0.5).z();
    if (cosine < 0.16) {
      EXPECT_TRUE(std::isnan(view.depth_m[i])) << cosine;
      EXPECT_EQ(view.cosine[i], 0);
    }
    if (cosine > 0.19) {
      EXPECT_FALSE(std::isnan(view.depth_m[i])) << cosine;
      EXPECT_GE(view.cosine[i], 1);
    }
  }
}

TEST(RenderView, PixelPitchIsTheAngleOfThePixel) {
  const ViewPose pose = Tilted(0.0);
  std::vector<float> pitch;
  base::ThreadPool threads(1);
  const RayCaster caster = [&](std::span<const render::Ray> rays, std::span<render::RayColor>) {
    for (const render::Ray& ray : rays) pitch.push_back(ray.pixel_pitch);
  };
  RenderView(pose, caster, Limits(), threads, [](int64_t) {});
  ASSERT_EQ(pitch.size(), 41U * 31U);
  const Eigen::Vector3d along_x = pose.DirectionAt(1.0, 0.5) - pose.DirectionAt(0.0, 0.5);
  const Eigen::Vector3d along_y = pose.DirectionAt(0.5, 1.0) - pose.DirectionAt(0.5, 0.0);
  EXPECT_NEAR(static_cast<double>(pitch[0]), std::sqrt(along_x.cross(along_y).norm()), 1e-5);
}

TEST(RenderView, DropsBlurredTransparentAndUnknownDepths) {
  AnalyticScene scene;
  scene.has_house = false;
  scene.change = [](const Eigen::Vector3d& x, render::RayColor& color) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    if (x.x() > 10.0) {
      color.opacity = 0.4F;
    } else if (x.x() < -10.0) {
      color.depth_back = color.depth_front + 1.5F;
    } else if (x.y() > 8.0) {
      color.depth_back = nan;
    } else if (x.y() < -8.0) {
      color.depth_median = nan;
    }
  };
  const ViewPose pose = Tilted(0.0);
  const RenderedView view = Render(pose, scene);
  int kept = 0;
  for (size_t i = 0; i < view.depth_m.size(); ++i) {
    const Eigen::Vector3d d = pose.DirectionAt(static_cast<double>(i % 41) + 0.5, static_cast<double>(i / 41) + 0.5);
    const Eigen::Vector3d x = Eigen::Vector3d(0, 0, 60) - d * (60.0 / d.z());
    const bool good = std::abs(x.x()) <= 10.0 && std::abs(x.y()) <= 8.0;
    EXPECT_EQ(!std::isnan(view.depth_m[i]), good) << x.transpose();
    kept += good ? 1 : 0;
  }
  EXPECT_GT(kept, 100);
}

// Ground blurred by 0.8 m of height: along the ray that is 0.8 m from above, and 2.3 m at a cosine of 0.35.
TEST(RenderView, ThinBlurAtAFlatAngleIsKeptWhereSpreadIsMeasuredAcross) {
  AnalyticScene scene;
  scene.has_house = false;
  double blur_m = 0.8;
  const ViewPose pose = Tilted(70.0, 41, 15);
  scene.change = [&](const Eigen::Vector3d& x, render::RayColor& color) {
    const double cosine = 60.0 / (x - pose.Centre()).norm();
    color.depth_back = color.depth_front + static_cast<float>(blur_m / cosine);
  };
  DepthLimits limits = Limits();
  const auto n_kept = [&] {
    const RenderedView view = Render(pose, scene, limits);
    EXPECT_TRUE(view.spread_m.empty());
    return std::count_if(view.depth_m.begin(), view.depth_m.end(), [](float depth) { return !std::isnan(depth); });
  };
  EXPECT_EQ(n_kept(), 0);
  limits.spread_across = true;
  EXPECT_EQ(n_kept(), 41 * 15);
  blur_m = 1.2;
  EXPECT_EQ(n_kept(), 0);
}

TEST(RenderView, DropsDepthsOutsideTheBoxAndCastsNoRaysBesideIt) {
  AnalyticScene scene;
  scene.has_house = false;
  DepthLimits limits = Limits();
  limits.min_enu = {-5.5, -1000.0, -5.0};
  limits.max_enu = {5.5, 1000.0, 10.0};
  const ViewPose pose = Tilted(0.0);
  const RenderedView view = Render(pose, scene, limits);
  EXPECT_LT(scene.rays, 41 * 31 / 2);
  for (int x = 0; x < 41; ++x) EXPECT_EQ(!std::isnan(view.depth_m[static_cast<size_t>(15 * 41 + x)]), std::abs(x - 20) <= 5) << x;
}

// A row of depths repeated over several rows, as seen by a camera whose rays are nearly parallel.
RenderedView Rows(const std::vector<float>& row, int height = 5) {
  RenderedView view;
  view.pose = Tilted(0.0, static_cast<int>(row.size()), height, 60.0);
  for (int y = 0; y < height; ++y) view.depth_m.insert(view.depth_m.end(), row.begin(), row.end());
  return view;
}

TEST(FilterDepths, DropsSpikesAndMixedPixelsButNoEdges) {
  base::ThreadPool threads(2);
  DepthLimits limits = Limits();
  limits.max_angle_deg = 89.9;
  RenderedView view = Rows({60, 60, 60, 45, 60, 60, 60, 60, 56, 52, 52, 52, 52});  // a spike; then a pixel between two surfaces
  FilterDepths(view, limits, threads);
  for (size_t x = 0; x < 13; ++x) EXPECT_EQ(std::isnan(view.depth_m[2 * 13 + x]), x == 3 || x == 8) << x;
}

TEST(FilterDepths, KeepsASurfaceWithLongSteps) {
  base::ThreadPool threads(2);
  DepthLimits limits = Limits();
  limits.max_angle_deg = 89.9;
  RenderedView view = Rows({60, 63, 66.3F, 69.9F, 74, 78.6F, 84, 90});
  FilterDepths(view, limits, threads);
  for (size_t x = 0; x < 8; ++x) EXPECT_FALSE(std::isnan(view.depth_m[2 * 8 + x])) << x;
}

TEST(FilterDepths, PixelsAloneAndEmptyPicturesAreLegal) {
  base::ThreadPool threads(2);
  RenderedView one;
  one.pose = Tilted(0.0, 1, 1);
  one.depth_m = {7.0F};
  FilterDepths(one, Limits(), threads);
  EXPECT_EQ(one.depth_m[0], 7.0F);
  EXPECT_EQ(one.cosine[0], 255);
  RenderedView none;
  none.pose = Tilted(0.0, 3, 3);
  none.depth_m.assign(9, std::numeric_limits<float>::quiet_NaN());
  FilterDepths(none, Limits(), threads);
  for (size_t i = 0; i < 9; ++i) {
    EXPECT_TRUE(std::isnan(none.depth_m[i]));
    EXPECT_EQ(none.cosine[i], 0);
  }
}

}  // namespace
}  // namespace skyquilt::surface
