// Nadir photos from 100 m above flat ground at 0 m, with points that were kept from training; rendered depths are made up.
#include "evaluate/photos/kept_points.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "tests/support/nadir_photo.h"
#include "tests/support/not_finite.h"

namespace skyquilt::evaluate::photos {
namespace {

constexpr int kFullWidth = 200;

class KeptPointsTest : public ::testing::Test {
 protected:
  // Photos 0 to 9 in a row; the even ones are held out.
  KeptPointsTest() {
    survey_.georeferenced = true;
    survey_.cameras = {{camera::CameraModel::kPinhole, kFullWidth, 160, {200.0, 200.0, 100.0, 80.0}}};
    for (int i = 0; i < 10; ++i) {
      survey_.photos.push_back(NadirPhoto({2.0 * i, 0.0, 100.0}, "p" + std::to_string(i) + ".jpg"));
      survey_.photos.back().is_test = i % 2 == 0;
    }
  }
  void Add(const Eigen::Vector3d& x_in_enu, std::vector<int32_t> photos) {
    survey_.kept_points.push_back({x_in_enu, {}, 0.5F, static_cast<int>(photos.size())});
    survey_.kept_tracks.Add(std::move(photos));
  }
  std::vector<KeptRay> Rays(size_t most = kMostKeptRays) const {
    return KeptRays(survey_, std::vector<int>(survey_.photos.size(), kFullWidth / 2), boxes_, most);
  }

  survey::Survey survey_;
  std::vector<geo::BlockBox> boxes_ = {{{-50.0, -50.0, -1.0}, {50.0, 0.0, 9.0}, 5.0}, {{-50.0, 0.0, -1.0}, {50.0, 50.0, 9.0}, 5.0}};
};

TEST_F(KeptPointsTest, RaysGoFromTheCamerasThroughThePoint) {
  Add({12.0, 30.0, 4.0}, {1, 3});
  const std::vector<KeptRay> rays = Rays();
  ASSERT_EQ(rays.size(), 2U);
  for (const KeptRay& ray : rays) {
    const Eigen::Vector3d end = ray.ray.origin_enu + ray.true_m * ray.ray.direction_enu;
    EXPECT_LT((end - survey_.kept_points[0].x_in_enu).norm(), 1e-9);
    EXPECT_NEAR(ray.ray.direction_enu.norm(), 1.0, 1e-12);
    EXPECT_EQ(ray.ray.origin_enu.z(), 100.0);
  }
  EXPECT_EQ(rays[0].photo, 1);
  EXPECT_EQ(rays[1].photo, 3);
}

TEST_F(KeptPointsTest, GsdIsThatOfTheFullPhotoAndTheRayThatOfTraining) {
  Add({6.0, 0.0, 0.0}, {3, 5});
  const std::vector<KeptRay> rays = Rays();
  ASSERT_EQ(rays.size(), 2U);
  // Straight below photo 3: focal length 200 pixels at full size, 100 in training.
  EXPECT_NEAR(rays[0].gsd_m, 100.0 / 200.0, 0.005);
  EXPECT_NEAR(static_cast<double>(rays[0].ray.pixel_pitch), 1.0 / 100.0, 1e-4);
}

TEST_F(KeptPointsTest, FourPhotosSpreadOverTheObserversHeldOutFirst) {
  Add({6.0, 0.0, 0.0}, {0, 1, 3, 4, 5, 7, 9});
  Add({6.0, 5.0, 0.0}, {0, 1, 2, 3, 4, 5, 6, 8});
  std::map<size_t, std::vector<int>> photos;
  for (const KeptRay& ray : Rays()) photos[ray.point].push_back(ray.photo);
  EXPECT_EQ(photos[0], (std::vector<int>{0, 4, 3, 7}));
  EXPECT_EQ(photos[1], (std::vector<int>{0, 2, 6, 8})) << "held-out ones are enough";
}

TEST_F(KeptPointsTest, PointsOutsideBlocksOrSeenByOneTrainingPhotoDoNotCount) {
  Add({60.0, 0.0, 0.0}, {1, 3, 5});
  Add({10.0, 0.0, 0.0}, {0, 1, 2, 4});
  EXPECT_TRUE(Rays().empty());
  Add({10.0, 0.0, 0.0}, {1, 3});
  EXPECT_EQ(Rays().size(), 2U);
}

TEST_F(KeptPointsTest, AboveTheLimitWholePointsAreLeftOutEvenly) {
  for (int i = 0; i < 1000; ++i) Add({i < 500 ? -40.0 : 40.0, 0.0, 0.0}, {1, 3, 5, 7});
  const std::vector<KeptRay> rays = Rays(402);
  EXPECT_EQ(rays.size(), 400U);
  std::set<size_t> points;
  for (const KeptRay& ray : rays) points.insert(ray.point);
  EXPECT_EQ(points.size(), 100U);
  const auto west = std::distance(points.begin(), points.lower_bound(500));
  EXPECT_GT(west, 30);
  EXPECT_LT(west, 70);
}

TEST_F(KeptPointsTest, ErrorsArePositiveBehindThePoint) {
  for (int i = 0; i < 5; ++i) Add({3.0 * i, 0.0, 0.0}, {1, 3});
  const std::vector<KeptRay> rays = Rays();
  std::vector<render::RayColor> rendered(rays.size());
  // In GSD: 0, 1, ..., 8 and one ray that meets nothing.
  for (size_t i = 0; i < rays.size(); ++i) {
    rendered[i].depth_median = static_cast<float>(rays[i].true_m + static_cast<double>(i) * rays[i].gsd_m);
  }
  rendered[9].depth_median = kNanFloat;
  const KeptPointErrors errors = CompareKeptRays(rays, rendered, true);
  EXPECT_EQ(errors.points, 5);
  EXPECT_EQ(errors.rays, 10);
  EXPECT_NEAR(errors.median_gsd, 5.0, 1e-3);
  EXPECT_NEAR(errors.median_abs_gsd, 5.0, 1e-3);
  EXPECT_NEAR(errors.nmad_gsd, 1.4826 * 3.0, 1e-3) << "5, 4, 3, 2, 1, 0, 1, 2, 3 and infinity";
  EXPECT_DOUBLE_EQ(errors.share_beyond_10_gsd, 0.1);
  EXPECT_NEAR(errors.median_m, 5.0 * 0.5, 0.1);
  EXPECT_TRUE(std::isnan(CompareKeptRays(rays, rendered, false).median_m)) << "a local frame has no metres";
  EXPECT_FALSE(std::isnan(CompareKeptRays(rays, rendered, false).nmad_gsd));

  for (render::RayColor& ray : rendered) ray.depth_median -= 10.0F;  // about 20 GSD in front
  const KeptPointErrors in_front = CompareKeptRays(rays, rendered, true);
  EXPECT_LT(in_front.median_m, -5.0);
  EXPECT_GT(in_front.median_abs_m, 5.0);
}

TEST_F(KeptPointsTest, NothingIsMeasuredWithoutRaysAndNoMedianIsInfinite) {
  EXPECT_EQ(CompareKeptRays({}, {}, true).rays, 0);
  Add({3.0, 0.0, 0.0}, {1, 3});
  const std::vector<KeptRay> rays = Rays();
  std::vector<render::RayColor> rendered(rays.size());
  for (render::RayColor& ray : rendered) ray.depth_median = kNanFloat;
  const KeptPointErrors errors = CompareKeptRays(rays, rendered, true);
  EXPECT_EQ(errors.rays, 2);
  EXPECT_TRUE(std::isnan(errors.median_gsd));
  EXPECT_TRUE(std::isnan(errors.nmad_m));
  EXPECT_DOUBLE_EQ(errors.share_beyond_10_gsd, 1.0);
}

}  // namespace
}  // namespace skyquilt::evaluate::photos
