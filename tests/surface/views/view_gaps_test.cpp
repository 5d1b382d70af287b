#include "surface/views/view_gaps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "surface/views/view_rendering.h"
#include "tests/surface/views/analytic_survey.h"

namespace skyquilt::surface {
namespace {

ViewPose PhotoAt(double x, double y) {
  ViewPose pose;
  pose.photo = 0;
  pose.width = 100;
  pose.height = 75;
  pose.focal_px = 100.0;
  pose.cx = 50.0;
  pose.cy = 37.5;
  pose.cam_from_enu = LookingDown({x, y, 60.0});
  return pose;
}

class ViewGaps : public testing::Test {
 protected:
  void Photograph(double x, double y) { Photograph(PhotoAt(x, y)); }
  void PhotographLevel(const Eigen::Vector3d& centre, double heading_deg) {
    ViewPose pose = PhotoAt(0, 0);
    pose.cam_from_enu = LookingLevel(centre, heading_deg);
    Photograph(pose);
  }
  void Photograph(const ViewPose& pose) {
    const DepthLimits limits{.max_spread_m = 2.7, .max_step_m = 1.8, .min_enu = {-900, -900, -3}, .max_enu = {900, 900, 90}};
    views_.push_back(RenderView(pose, scene_.Caster(), limits, threads_, [](int64_t) {}));
  }
  CoarseDepths Coarse(double limit_bytes = 64e6) const {
    CoarseDepths coarse(static_cast<int64_t>(views_.size()) * 7500, limit_bytes);
    for (const RenderedView& view : views_) coarse.Add(view.Get());
    return coarse;
  }
  std::vector<ViewPose> Plan(int64_t budget = int64_t{1} << 40, bool level = false) {
    return PlanGapViews(Coarse(), {.voxel_m = 0.45, .min_views = 3, .agl_m = 60.0, .budget_rays = budget, .level = level}, threads_);
  }
  std::vector<ViewPose> PlanLevel() { return Plan(int64_t{1} << 40, true); }

  AnalyticScene scene_;
  base::ThreadPool threads_{2};
  std::vector<RenderedView> views_;
};

bool LooksDown(const ViewPose& pose) {
  return pose.DirectionAt(pose.cx, pose.cy).z() < -0.999;
}

TEST_F(ViewGaps, CountsTheViewsThatSeeAPlace) {
  scene_.has_house = false;
  Photograph(0, 0);
  Photograph(20, 0);
  // With and without thinning.
  for (const double limit_bytes : {64e6, 5e3}) {
    for (const SurfaceSample& sample : Coarse(limit_bytes).Samples(2000, 1.35, threads_)) {
      const bool by_first = std::abs(sample.position.x()) < 30.0, by_second = std::abs(sample.position.x() - 20.0) < 30.0;
      EXPECT_EQ(sample.views, (by_first ? 1 : 0) + (by_second ? 1 : 0)) << sample.position.transpose();
      EXPECT_NEAR(sample.position.z(), 0.0, 1e-3);
    }
  }
}

TEST_F(ViewGaps, WhatHidesAPlaceDoesNotSeeIt) {
  scene_.house_max.z() = 20.0;
  Photograph(0, 0);
  const CoarseDepths coarse = Coarse();
  EXPECT_TRUE(coarse.Sees(0, {0.0, 0.0, 20.0}, 1.35));
  EXPECT_FALSE(coarse.Sees(0, {0.0, 0.0, 0.0}, 1.35));    // below the roof
  EXPECT_FALSE(coarse.Sees(0, {6.0, 0.0, 0.0}, 1.35));    // behind its edge
  EXPECT_FALSE(coarse.Sees(0, {12.0, 0.0, 10.0}, 1.35));  // in the air
  EXPECT_TRUE(coarse.Sees(0, {12.0, 0.0, 0.0}, 1.35));
  EXPECT_FALSE(coarse.Sees(0, {0.0, 0.0, 70.0}, 1.35));  // behind the camera
  EXPECT_FALSE(coarse.Sees(0, {40.0, 0.0, 0.0}, 1.35));  // outside the image
  EXPECT_NEAR(coarse.LookAtPlace(0, {0.0, 0.0, 0.0})->behind_m, 20.0, 0.05);
  EXPECT_NEAR(coarse.LookAtPlace(0, {0.0, 0.0, 30.0})->behind_m, -10.0, 0.05);
  EXPECT_FALSE(coarse.LookAtPlace(0, {40.0, 0.0, 0.0}));
}

TEST_F(ViewGaps, WeakPlacesGetViewsAndWellCoveredOnesDoNot) {
  scene_.has_house = false;
  for (int x = -3; x <= 3; ++x) {
    for (int y = -3; y <= 3; ++y) Photograph(10 * x, 10 * y);
  }
  Photograph(300, 0);
  int near_alone = 0;
  for (const ViewPose& pose : Plan()) {
    EXPECT_EQ(pose.photo, -1);
    const Eigen::Vector3d c = pose.Centre();
    if (!LooksDown(pose)) continue;
    EXPECT_NEAR(c.z(), 60.0, 0.1);
    EXPECT_FALSE(std::abs(c.x()) < 30.0 && std::abs(c.y()) < 30.0) << c.transpose();
    if (std::abs(c.x() - 300.0) < 30.0 && std::abs(c.y()) < 22.5) ++near_alone;
  }
  EXPECT_GE(near_alone, 3);
}

TEST_F(ViewGaps, ObliqueViewsComeAfterNadirOnesAndLookAtThePlace) {
  scene_.has_house = false;
  Photograph(0, 0);
  const std::vector<ViewPose> views = Plan();
  const size_t n_nadir = views.size() / 5;
  ASSERT_EQ(views.size(), 5 * n_nadir);
  ASSERT_GT(n_nadir, 0U);
  for (size_t i = 0; i < views.size(); ++i) {
    EXPECT_EQ(LooksDown(views[i]), i < n_nadir) << i;
    if (i < n_nadir) continue;
    const Eigen::Vector3d place = views[(i - n_nadir) / 4].Centre() - Eigen::Vector3d(0, 0, 60);
    const std::optional<Eigen::Vector2d> pixel = views[i].Project(place);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR((*pixel - Eigen::Vector2d(views[i].cx, views[i].cy)).norm(), 0.0, 1e-6);
    EXPECT_NEAR(views[i].DirectionAt(views[i].cx, views[i].cy).z(), -std::sqrt(0.5), 1e-6);
    // Upright: what is above the place is higher in the picture.
    EXPECT_LT(views[i].Project(place + Eigen::Vector3d(0, 0, 5))->y(), pixel->y());
  }
  // The budget cuts off the last ones only.
  const int64_t rays = static_cast<int64_t>(views[0].width) * views[0].height;
  const std::vector<ViewPose> fewer = Plan(rays * 3 + rays / 2);
  ASSERT_EQ(fewer.size(), 3U);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(fewer[i].Centre(), views[i].Centre());
  EXPECT_TRUE(Plan(rays - 1).empty());
}

TEST_F(ViewGaps, CamerasAreNotInsideTowers) {
  scene_.house_min = {55.0, -10.0, 0.0};
  scene_.house_max = {75.0, 10.0, 70.0};  // higher than the flight, where an oblique camera would be
  Photograph(0, 0);
  ViewPose tower = PhotoAt(65.0, 0.0);
  tower.cam_from_enu = LookingDown({65.0, 0.0, 130.0});
  Photograph(tower);
  int above = 0;
  for (const ViewPose& pose : Plan()) {
    const Eigen::Vector3d c = pose.Centre();
    const bool over_tower = c.x() > 54.0 && c.x() < 76.0 && std::abs(c.y()) < 11.0;
    EXPECT_TRUE(!over_tower || c.z() > 75.0) << c.transpose();
    above += over_tower ? 1 : 0;
  }
  EXPECT_GT(above, 0);
}

// Three photos of a long facade, 20 m in front of it at eye level.
TEST_F(ViewGaps, LevelPhotosGetViewsBesideThem) {
  scene_.house_min = {-40.0, 0.0, 0.0};
  scene_.house_max = {40.0, 10.0, 15.0};
  for (const double x : {-10.0, 0.0, 10.0}) PhotographLevel({x, -20.0, 1.7}, 0.0);
  const std::vector<ViewPose> views = PlanLevel();
  int halfway = 0;
  for (const ViewPose& pose : views) {
    EXPECT_EQ(pose.photo, -1);
    const Eigen::Vector3d c = pose.Centre();
    EXPECT_NEAR(c.z(), 1.7, 1e-9) << "neither in the ground nor above all photos";
    EXPECT_NEAR(c.y(), -20.0, 5.0);
    EXPECT_LT(std::abs(c.x()), 15.1);
    EXPECT_GT(pose.DirectionAt(pose.cx, pose.cy).y(), 0.5) << "towards what the photos show";
    for (const RenderedView& photo : views_) EXPECT_GT((photo.pose.Centre() - c).norm(), 0.2);
    halfway += std::abs(std::abs(c.x()) - 5.0) < 1.5 && std::abs(c.y() + 20.0) < 2.5 ? 1 : 0;
  }
  ASSERT_GT(halfway, 0);
  // The budget cuts off the last ones only.
  const int64_t rays = static_cast<int64_t>(views[0].width) * views[0].height;
  const std::vector<ViewPose> fewer = Plan(rays * 3, true);
  ASSERT_EQ(fewer.size(), 3U);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(fewer[i].Centre(), views[i].Centre());
}

TEST_F(ViewGaps, NoneIsBehindAWallThatAPhotoShows) {
  // A wall beside the first photo, which looks past it.
  scene_.house_min = {4.0, -40.0, 0.0};
  scene_.house_max = {5.0, 40.0, 12.0};
  PhotographLevel({3.2, 0.0, 6.0}, -30.0);
  PhotographLevel({-0.8, 0.0, 6.0}, -50.0);
  // Where the third photo shows the wall, and not at so flat an angle that its depths are uncertain.
  const auto beyond = [](const std::vector<ViewPose>& views) {
    return std::count_if(views.begin(), views.end(), [](const ViewPose& pose) {
      return pose.Centre().x() > 4.0 && pose.Centre().x() < 20.0 && std::abs(pose.Centre().y()) < 11.0;
    });
  };
  EXPECT_GT(beyond(PlanLevel()), 0) << "no photo shows the wall where the first one stands: this test tests nothing";
  PhotographLevel({0.0, -15.0, 6.0}, 20.0);
  EXPECT_FALSE(PlanLevel().empty());
  EXPECT_EQ(beyond(PlanLevel()), 0);
}

TEST_F(ViewGaps, ALonePhotoGetsViewsFromItsSideOfTheWall) {
  // It looks along a wall: straight across the line of sight one would soon be behind it.
  scene_.house_min = {6.0, -400.0, 0.0};
  scene_.house_max = {9.0, 400.0, 40.0};
  PhotographLevel({0.0, 0.0, 18.0}, 30.0);
  EXPECT_FALSE(PlanLevel().empty());
  for (const ViewPose& pose : PlanLevel()) EXPECT_LT(pose.Centre().x(), 6.0);
}

TEST_F(ViewGaps, WithoutPhotosOrDepthsThereAreNoViews) {
  EXPECT_TRUE(Plan().empty());
  EXPECT_TRUE(PlanLevel().empty());
  RenderedView blind;
  blind.pose = PhotoAt(0, 0);
  blind.depth_m.assign(7500, std::numeric_limits<float>::quiet_NaN());
  blind.cosine.assign(7500, 0);
  views_.push_back(blind);
  EXPECT_TRUE(Plan().empty());
  EXPECT_TRUE(PlanLevel().empty());
  // Thinned so much that no pixel is left.
  EXPECT_TRUE(Coarse(0.1).Samples(1000, 1.0, threads_).empty());
}

}  // namespace
}  // namespace skyquilt::surface
