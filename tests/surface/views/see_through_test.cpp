#include "surface/views/see_through.h"

#include <gtest/gtest.h>

#include "surface/views/view_rendering.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

// A wall at y = 0, seen from 20 m in the south.
class SeesThroughPlaces : public testing::Test {
 protected:
  SeesThroughPlaces() {
    scene_.house_min = {-40.0, 0.0, 0.0};
    scene_.house_max = {40.0, 10.0, 8.0};
    pose_.photo = 0;
    pose_.width = 100;
    pose_.height = 75;
    pose_.focal_px = 100.0;
    pose_.cx = 50.0;
    pose_.cy = 37.5;
    pose_.cam_from_enu = LookingLevel({0.0, -20.0, 5.0}, 0.0);
    Render(-1.0);
  }
  void Render(double max_free_opacity) {
    const DepthLimits limits{
        .max_free_opacity = max_free_opacity, .max_spread_m = 2.7, .max_step_m = 1.8, .min_enu = {-900, -900, -3}, .max_enu = {900, 900, 90}};
    view_ = RenderView(pose_, scene_.Caster(), limits, threads_, [](int64_t) {});
  }
  bool Through(const Eigen::Vector3d& x, double tolerance_m = 1.0, const Eigen::Vector3d& normal = {0.0, -1.0, 0.0}) const {
    const DepthView view = view_.Get();
    return SeesThrough({&view, 1}, x, normal, tolerance_m);
  }

  ViewPose pose_;
  AnalyticScene scene_;
  base::ThreadPool threads_{1};
  RenderedView view_;
};

TEST_F(SeesThroughPlaces, OnlyInFrontOfWhatThePhotoShows) {
  for (const double x : {-8.0, 0.0, 3.3, 7.0}) {
    EXPECT_TRUE(Through({x, -2.0, 5.0})) << x;
    EXPECT_TRUE(Through({x, -2.0, 5.0}, 1.0, {0.0, 1.0, 0.0})) << "from behind too";
    EXPECT_FALSE(Through({x, -2.0, 5.0}, 3.0)) << "within the tolerance";
    EXPECT_FALSE(Through({x, 0.0, 5.0}, 0.05)) << "the wall itself";
    EXPECT_FALSE(Through({x, 5.0, 5.0})) << "behind it";
  }
}

TEST_F(SeesThroughPlaces, NothingIsKnownOfOtherPlaces) {
  EXPECT_FALSE(Through({15.0, -2.0, 5.0})) << "outside the image";
  EXPECT_FALSE(Through({0.0, -25.0, 5.0})) << "behind the camera";
  EXPECT_FALSE(Through({0.0, -5.0, 9.0})) << "no depth";
  EXPECT_FALSE(Through({0.0, -2.0, 5.0}, 1.0, {1.0, 0.0, 0.0})) << "seen along the surface";
  view_.pose.photo = -1;
  EXPECT_FALSE(Through({0.0, -2.0, 5.0})) << "not a photo";
}

TEST_F(SeesThroughPlaces, WhereARayMeetsNothing) {
  Render(0.05);
  EXPECT_TRUE(Through({0.0, -5.0, 9.0})) << "before the sky";
  EXPECT_FALSE(Through({0.0, -5.0, 9.0}, 1.0, {1.0, 0.0, 0.0})) << "seen along the surface";
  EXPECT_FALSE(Through({0.0, 0.0, 5.0}, 0.05)) << "the wall";
}

}  // namespace
}  // namespace skyquilt::surface
