#include "evaluate/photos/coverage.h"

#include <gtest/gtest.h>

#include "tests/evaluate/photos/nadir_view.h"
#include "tests/support/not_finite.h"

namespace skyquilt::evaluate::photos {
namespace {

TEST(SurfacePoint, KeepsADepthInsideTheHeights) {
  const auto point = SurfacePoint({1, 2, 100}, {0, 0, -1}, 95.0, {0.0, 20.0});
  ASSERT_TRUE(point.has_value());
  EXPECT_NEAR(point->z(), 5.0, 1e-12);
}

TEST(SurfacePoint, FloaterAndHoleAreMovedIntoTheHeights) {
  EXPECT_NEAR(SurfacePoint({0, 0, 100}, {0, 0, -1}, 3.0, {0.0, 20.0})->z(), 20.0, 1e-9);
  EXPECT_NEAR(SurfacePoint({0, 0, 100}, {0, 0, -1}, kNan, {0.0, 20.0})->z(), 0.0, 1e-9);
  EXPECT_NEAR(SurfacePoint({0, 0, 100}, {0, 0, -1}, 1e9, {0.0, 20.0})->z(), 0.0, 1e-9);
}

TEST(SurfacePoint, NothingForRaysThatMissTheHeights) {
  EXPECT_FALSE(SurfacePoint({0, 0, 100}, {0, 0, 1}, 50.0, {0.0, 20.0}).has_value());
  EXPECT_FALSE(SurfacePoint({0, 0, 100}, {1, 0, 0}, 50.0, {0.0, 20.0}).has_value());
  EXPECT_FALSE(SurfacePoint({0, 0, 10}, {1, 0, 0}, kNan, {0.0, 20.0}).has_value());
}

TEST(SurfacePoint, CameraInsideTheHeightsKeepsNearSurfaces) {
  const auto point = SurfacePoint({0, 0, 10}, {1, 0, 0}, 4.0, {0.0, 20.0});
  ASSERT_TRUE(point.has_value());
  EXPECT_NEAR(point->x(), 4.0, 1e-12);
}

TEST(TrainingViews, CountsOnlyViewsWhoseFrameHoldsThePoint) {
  // From 100 m up, each frame spans 100 m x 80 m on the ground.
  const TrainingViews views({NadirView(0, 0, 100), NadirView(60, 0, 100), NadirView(120, 0, 100)});
  std::vector<int> order = views.ByDistance({0, 0, 100});
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(views.Count({0, 0, 0}, order, 9), 1);
  EXPECT_EQ(views.Count({30, 0, 0}, order, 9), 2);
  EXPECT_EQ(views.Count({60, 0, 0}, order, 9), 1);
  EXPECT_EQ(views.Count({30, 41, 0}, order, 9), 0);
  EXPECT_EQ(views.Count({30, 39, 0}, order, 9), 2);
}

TEST(TrainingViews, PointsBehindACameraAreNotSeen) {
  const TrainingViews views({NadirView(0, 0, 100)});
  EXPECT_TRUE(views.Sees(0, {0, 0, 99}));
  EXPECT_FALSE(views.Sees(0, {0, 0, 101}));
}

TEST(TrainingViews, MaskedPixelsDoNotSee) {
  TrainingView view = NadirView(0, 0, 100);
  std::vector<uint8_t> mask(100 * 80, 1);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 50; ++x) mask[static_cast<size_t>(y * 100 + x)] = 0;  // the western half
  }
  view.mask = mask;
  const TrainingViews views({view});
  EXPECT_FALSE(views.Sees(0, {-10, 0, 0}));
  EXPECT_TRUE(views.Sees(0, {10, 0, 0}));
}

TEST(TrainingViews, StopsCountingAtEnough) {
  const TrainingViews views({NadirView(0, 0, 100), NadirView(1, 0, 100), NadirView(2, 0, 100)});
  EXPECT_EQ(views.Count({0, 0, 0}, views.ByDistance({0, 0, 0}), 2), 2);
  EXPECT_EQ(TrainingViews({}).Count({0, 0, 0}, {}, 2), 0);
}

// A wall from x = -20 to 20 at z = 30 hides the ground below it, but no place that the small pixels beside it may show, and nothing before it.
TEST(TrainingViews, WhatStandsBeforeAPlaceHidesIt) {
  TrainingView view = NadirView(0, 0, 100);
  view.depth_m = image::ImageF(50, 40, 1);  // a pixel is 2 m of ground wide
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 50; ++x) {
      const double to_ground_m = Eigen::Vector3d(2.0 * x + 1.0 - 50.0, 2.0 * y + 1.0 - 40.0, 100.0).norm();
      *view.depth_m.At(x, y) = static_cast<float>((x >= 15 && x < 35 ? 0.7 : 1.0) * to_ground_m);
    }
  }
  const TrainingViews views({view, NadirView(0, 0, 100)});
  EXPECT_FALSE(views.Sees(0, {0, 0, 0}));
  EXPECT_TRUE(views.Sees(1, {0, 0, 0})) << "without a picture nothing hides it";
  EXPECT_TRUE(views.Sees(0, {0, 0, 30}));
  EXPECT_TRUE(views.Sees(0, {0, 0, 28.5})) << "the wall itself, rendered a little too near";
  EXPECT_FALSE(views.Sees(0, {0, 0, 25}));
  EXPECT_TRUE(views.Sees(0, {40, 0, 0}));
  EXPECT_TRUE(views.Sees(0, {20.5, 0, 0})) << "beside the border";
  EXPECT_FALSE(views.Sees(0, {17.5, 0, 0}));
  EXPECT_TRUE(views.Sees(0, {49.9, 39.9, 0})) << "in the corner of the frame";
  EXPECT_EQ(views.Count({0, 0, 0}, views.ByDistance({0, 0, 0}), 2), 1);
}

TEST(TrainingViews, NothingHidesWhatARayWithoutSurfacePassesOver) {
  TrainingView view = NadirView(0, 0, 100);
  view.depth_m = image::ImageF(1, 1, 1, kNanFloat);
  EXPECT_TRUE(TrainingViews({view}).Sees(0, {0, 0, -1e6}));
}

// Strong barrel distortion projects points far outside the view into the image.
TEST(TrainingViews, FoldedDistortionIsNotSeen) {
  TrainingView view = NadirView(0, 0, 100);
  view.camera.model = camera::CameraModel::kSimpleRadial;
  view.camera.params = {100.0, 50.0, 40.0, -0.3};
  ASSERT_TRUE(view.camera.Problem().empty());
  const TrainingViews views({view});
  EXPECT_TRUE(views.Sees(0, {10, 10, 0}));
  for (double x = 150.0; x < 400.0; x += 5.0) EXPECT_FALSE(views.Sees(0, {x, 0, 0})) << x;
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
