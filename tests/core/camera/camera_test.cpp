#include "core/camera/camera.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "core/base/random.h"
#include "core/camera/corner_radius.h"

namespace skyquilt::camera {
namespace {

// One lens per model, with parameters typical of drone cameras (fisheye: an action camera).
std::vector<Camera> RealisticCameras() {
  return {
      {CameraModel::kSimplePinhole, 4000, 3000, {2850.0, 2003.0, 1497.0}},
      {CameraModel::kPinhole, 4000, 3000, {2850.0, 2846.0, 2003.0, 1497.0}},
      {CameraModel::kSimpleRadial, 4000, 3000, {2850.0, 2003.0, 1497.0, -0.12}},
      {CameraModel::kSimpleRadial, 4000, 3000, {2850.0, 2003.0, 1497.0, 0.12}},
      {CameraModel::kRadial, 5472, 3648, {3650.0, 2736.0, 1824.0, -0.27, 0.11}},
      {CameraModel::kOpencv, 5472, 3648, {3650.0, 3648.0, 2736.0, 1824.0, -0.27, 0.11, 8e-4, -6e-4}},
      {CameraModel::kOpencvFisheye, 4000, 3000, {2200.0, 2206.0, 2010.0, 1490.0, 0.05, -0.02, 0.006, -0.001}},
      {CameraModel::kFullOpencv, 5472, 3648, {3650.0, 3648.0, 2736.0, 1824.0, 0.3, -0.08, 5e-4, 7e-4, 0.01, 0.55, -0.02, 0.005}},
      {CameraModel::kFov, 4000, 3000, {2200.0, 2206.0, 2010.0, 1490.0, 0.9}},
      {CameraModel::kSimpleRadialFisheye, 4000, 3000, {2200.0, 2010.0, 1490.0, 0.03}},
      {CameraModel::kRadialFisheye, 4000, 3000, {2200.0, 2010.0, 1490.0, 0.05, -0.01}},
      {CameraModel::kThinPrismFisheye, 4000, 3000, {2200.0, 2206.0, 2010.0, 1490.0, 0.05, -0.02, 8e-4, -6e-4, 0.006, -0.001, 1e-3, -2e-3}},
      {CameraModel::kRadTanThinPrismFisheye,
       4000,
       3000,
       {2200.0, 2206.0, 2010.0, 1490.0, 0.05, -0.02, 0.006, -0.001, 1e-4, -1e-5, 8e-4, -6e-4, 1e-3, -3e-4, -2e-3, 4e-4}},
  };
}

TEST(Camera, EveryPixelComesBack) {
  for (const Camera& camera : RealisticCameras()) {
    ASSERT_EQ(camera.Problem(), "");
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 30; ++j) {
        // Also a tenth of the image beyond each edge, as footprints need.
        const Eigen::Vector2d pixel(camera.width * (-0.1 + 1.2 * i / 40.0), camera.height * (-0.1 + 1.2 * j / 30.0));
        const Eigen::Vector3d ray = camera.RayFromImg(pixel);
        ASSERT_NEAR(ray.norm(), 1.0, 1e-12);
        const auto back = camera.ImgFromCam(137.0 * ray);
        ASSERT_TRUE(back.has_value()) << ModelName(camera.model) << " at " << pixel.transpose();
        ASSERT_LT((*back - pixel).norm(), 1e-8) << ModelName(camera.model) << " at " << pixel.transpose();
      }
    }
  }
}

TEST(Camera, EveryDirectionComesBack) {
  base::Random random(1);
  for (const Camera& camera : RealisticCameras()) {
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3d x{random.Uniform(-0.7, 0.7), random.Uniform(-0.5, 0.5), 1.0};
      const auto pixel = camera.ImgFromCam(x);
      ASSERT_TRUE(pixel.has_value());
      ASSERT_LT((camera.RayFromImg(*pixel) - x.normalized()).norm(), 1e-11) << ModelName(camera.model) << " at " << x.transpose();
    }
  }
}

TEST(Camera, RayOfThePrincipalPointIsForward) {
  for (const Camera& camera : RealisticCameras()) {
    EXPECT_LT((camera.RayFromImg(camera.PrincipalPoint()) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_LT((*camera.ImgFromCam({0.0, 0.0, 3.0}) - camera.PrincipalPoint()).norm(), 1e-12);
    EXPECT_LT((*camera.ImgFromCam({1e-14, 0.0, 3.0}) - camera.PrincipalPoint()).norm(), 1e-9);
    const Eigen::Vector2d right = *camera.ImgFromCam({0.1, 0.0, 1.0});
    const Eigen::Vector2d down = *camera.ImgFromCam({0.0, 0.1, 1.0});
    EXPECT_GT(right.x(), camera.PrincipalPoint().x());
    EXPECT_GT(down.y(), camera.PrincipalPoint().y());
  }
}

TEST(CornerRadius, IsOneAtTheFarthestCorner) {
  const Camera camera{CameraModel::kSimplePinhole, 4000, 3000, {2850.0, 2100.0, 1500.0}};
  const CornerRadius radius(camera);
  EXPECT_EQ(radius.Squared(camera.PrincipalPoint()), 0.0F);
  EXPECT_FLOAT_EQ(radius.Squared({0.0, 0.0}), 1.0F);
  EXPECT_FLOAT_EQ(radius.Squared({0.0, 3000.0}), 1.0F);
  EXPECT_LT(radius.Squared({4000.0, 3000.0}), 1.0F);
  EXPECT_FLOAT_EQ(radius.Squared({1050.0, 750.0}), 0.25F);
}

// Worked by hand from the formulas in COLMAP src/colmap/sensor/models.h at u = 0.5, v = 0.25 (r^2 = 0.3125).
TEST(Camera, MatchesTheFormulasByHand) {
  const Eigen::Vector3d x(1.0, 0.5, 2.0);
  const double s = 0.3125;
  const auto expect = [&](CameraModel model, const std::vector<double>& params, double u, double v) {
    const Camera camera{model, 1000, 1000, params};
    const Eigen::Vector2d focal(camera.FocalX(), camera.FocalY());
    const Eigen::Vector2d expected = Eigen::Vector2d(u, v).cwiseProduct(focal) + camera.PrincipalPoint();
    EXPECT_LT((*camera.ImgFromCam(x) - expected).norm(), 1e-9) << ModelName(model);
  };
  expect(CameraModel::kSimplePinhole, {800, 510, 490}, 0.5, 0.25);
  expect(CameraModel::kPinhole, {800, 700, 510, 490}, 0.5, 0.25);
  const double one = 1.0 + 0.1 * s;
  expect(CameraModel::kSimpleRadial, {800, 510, 490, 0.1}, 0.5 * one, 0.25 * one);
  const double two = one - 0.2 * s * s;
  expect(CameraModel::kRadial, {800, 510, 490, 0.1, -0.2}, 0.5 * two, 0.25 * two);
  // p1 = 0.01, p2 = 0.02: du = 2 p1 u v + p2 (r^2 + 2 u^2) = 0.01875, dv = 2 p2 u v + p1 (r^2 + 2 v^2) = 0.009375.
  expect(CameraModel::kOpencv, {800, 700, 510, 490, 0.1, -0.2, 0.01, 0.02}, 0.5 * two + 0.01875, 0.25 * two + 0.009375);
  const double full = (two + 0.3 * s * s * s) / (1.0 + 0.04 * s + 0.05 * s * s + 0.06 * s * s * s);
  expect(CameraModel::kFullOpencv, {800, 700, 510, 490, 0.1, -0.2, 0.01, 0.02, 0.3, 0.04, 0.05, 0.06}, 0.5 * full + 0.01875, 0.25 * full + 0.009375);
  const double theta = std::atan(std::sqrt(s));
  const double t2 = theta * theta;
  const double bent = theta * (1.0 + 0.1 * t2 - 0.02 * t2 * t2 + 0.03 * t2 * t2 * t2 - 0.004 * t2 * t2 * t2 * t2) / std::sqrt(s);
  expect(CameraModel::kOpencvFisheye, {800, 700, 510, 490, 0.1, -0.02, 0.03, -0.004}, 0.5 * bent, 0.25 * bent);
}

TEST(Camera, PointsBehindTheCameraAreNotProjected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Camera& camera : RealisticCameras()) {
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(0.1, 0.1, -1),
                                     Eigen::Vector3d(nan, 0, 1), Eigen::Vector3d(0, 0, HUGE_VAL), Eigen::Vector3d(1e300, 0, 1e-300)}) {
      EXPECT_FALSE(camera.ImgFromCam(x).has_value()) << ModelName(camera.model) << " at " << x.transpose();
    }
  }
}

// r (1 + k r^2) with k = -0.5 folds at r = sqrt(2/3), where its value is 0.5443; points beyond would be projected into the image.
TEST(Camera, PointsBeyondTheFoldAreNotProjected) {
  const Camera camera{CameraModel::kSimpleRadial, 2000, 2000, {1000.0, 1000.0, 1000.0, -0.5}};
  const double fold = std::sqrt(2.0 / 3.0);
  EXPECT_TRUE(camera.ImgFromCam({0.999 * fold, 0.0, 1.0}).has_value());
  for (const double r : {1.001 * fold, 1.2, 1.41, 2.0, 100.0}) EXPECT_FALSE(camera.ImgFromCam({0.0, r, 1.0}).has_value()) << r;
  for (const double pixel_offset : {544.0, 545.0, 900.0, 1e6}) {
    const Eigen::Vector3d ray = camera.RayFromImg({1000.0 + pixel_offset, 1000.0});
    const double tolerance = pixel_offset < 544.3 ? 0.05 : 1e-6;
    EXPECT_NEAR(ray.x() / ray.z(), fold, tolerance) << pixel_offset;
    EXPECT_NEAR(ray.y(), 0.0, 1e-12);
  }
}

// k1 < 0 and k2 > 0: the radius stops growing, then grows again; only the first branch describes the lens.
TEST(Camera, SecondBranchIsNotTaken) {
  const Camera camera{CameraModel::kRadial, 2000, 2000, {1000.0, 1000.0, 1000.0, -0.6, 0.15}};
  EXPECT_FALSE(camera.ImgFromCam({1.9, 0.0, 1.0}).has_value());
  for (int offset = 0; offset <= 5000; offset += 10) {
    const Eigen::Vector3d ray = camera.RayFromImg({1000.0 + offset, 1000.0});
    // Slope 1 - 1.8 s + 0.75 s^2 vanishes first at s = 0.8735.
    ASSERT_LE(ray.x() / ray.z(), std::sqrt(0.8735) + 1e-3) << offset;
  }
}

TEST(Camera, RaysAreNeverNan) {
  base::Random random(3);
  const std::vector<double> sizes = {0.0, 0.1, 1.0, 10.0, 1e4};
  for (int trial = 0; trial < 3000; ++trial) {
    Camera camera{*ModelFromId(static_cast<int>(random.Below(12))), 1000, 800, {}};
    camera.params.assign(static_cast<size_t>(ModelParamCount(camera.model)), 0.0);
    const double size = sizes[random.Below(5)];
    for (double& value : camera.params) value = size * random.Normal();
    camera.params[0] = 700.0;
    if (!HasOneFocalLength(camera.model)) camera.params[1] = 710.0;
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d{random.Uniform(-2000.0, 3000.0), random.Uniform(-2000.0, 3000.0)}, camera.PrincipalPoint(), Eigen::Vector2d(1e9, -1e9),
          Eigen::Vector2d(1e300, 1.0), Eigen::Vector2d(HUGE_VAL, 0.0), Eigen::Vector2d(std::numeric_limits<double>::quiet_NaN(), 0.0)}) {
      const Eigen::Vector3d ray = camera.RayFromImg(pixel);
      ASSERT_TRUE(ray.allFinite()) << ModelName(camera.model) << " trial " << trial << " at " << pixel.transpose();
      ASSERT_NEAR(ray.norm(), 1.0, 1e-9) << ModelName(camera.model) << " trial " << trial << " at " << pixel.transpose();
    }
  }
}

TEST(Camera, ResizedCameraHasTheSameRays) {
  for (const Camera& camera : RealisticCameras()) {
    // A quarter exactly, and a size whose rounding changes the aspect.
    for (const auto& [width, height] : {std::pair(camera.width / 4, camera.height / 4), std::pair(641, 487)}) {
      const Camera small = camera.Resized(width, height);
      ASSERT_EQ(small.Problem(), "");
      for (int i = 0; i <= 10; ++i) {
        const Eigen::Vector2d share(i / 10.0, (10 - i) / 12.0);
        const Eigen::Vector3d ray = camera.RayFromImg(share.cwiseProduct(Eigen::Vector2d(camera.width, camera.height)));
        const Eigen::Vector3d small_ray = small.RayFromImg(share.cwiseProduct(Eigen::Vector2d(width, height)));
        EXPECT_LT((ray - small_ray).norm(), 1e-10) << ModelName(camera.model) << " to " << width << " x " << height;
      }
    }
    EXPECT_EQ(camera.Resized(camera.width / 2, camera.height / 2).model, camera.model);
  }
}

TEST(Camera, ProblemsAreNamed) {
  const Camera good{CameraModel::kPinhole, 100, 80, {90.0, 90.0, 50.0, 40.0}};
  EXPECT_EQ(good.Problem(), "");
  Camera bad = good;
  bad.width = 0;
  EXPECT_NE(bad.Problem().find("size"), std::string::npos);
  bad = good;
  bad.params.pop_back();
  EXPECT_NE(bad.Problem().find("parameters"), std::string::npos);
  EXPECT_THROW(bad.RayFromImg({0.0, 0.0}), std::logic_error);
  bad = good;
  bad.params[1] = -90.0;
  EXPECT_NE(bad.Problem().find("focal"), std::string::npos);
  bad = good;
  bad.params[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(bad.Problem().find("finite"), std::string::npos);
  Camera fov{CameraModel::kFov, 100, 80, {90.0, 90.0, 50.0, 40.0, 0.9}};
  EXPECT_EQ(fov.Problem(), "");
  fov.params[4] = 3.5;
  EXPECT_NE(fov.Problem().find("omega"), std::string::npos);
}

TEST(CameraModel, NamesAndIdsAreThoseOfColmap) {
  // Ids and counts of COLMAP src/colmap/sensor/models.h.
  const std::vector<std::pair<std::string, int>> colmap = {{"SIMPLE_PINHOLE", 3},
                                                           {"PINHOLE", 4},
                                                           {"SIMPLE_RADIAL", 4},
                                                           {"RADIAL", 5},
                                                           {"OPENCV", 8},
                                                           {"OPENCV_FISHEYE", 8},
                                                           {"FULL_OPENCV", 12},
                                                           {"FOV", 5},
                                                           {"SIMPLE_RADIAL_FISHEYE", 4},
                                                           {"RADIAL_FISHEYE", 5},
                                                           {"THIN_PRISM_FISHEYE", 12},
                                                           {"RAD_TAN_THIN_PRISM_FISHEYE", 16}};
  for (size_t id = 0; id < colmap.size(); ++id) {
    const auto model = ModelFromId(static_cast<int>(id));
    ASSERT_TRUE(model.has_value());
    EXPECT_EQ(ModelName(*model), colmap[id].first);
    EXPECT_EQ(ModelParamCount(*model), colmap[id].second);
    EXPECT_EQ(ModelFromName(colmap[id].first), model);
  }
  EXPECT_FALSE(ModelFromId(12).has_value());
  EXPECT_FALSE(ModelFromId(-1).has_value());
  EXPECT_FALSE(ModelFromName("EUCM").has_value());
  EXPECT_TRUE(ModelNames().ends_with("THIN_PRISM_FISHEYE or RAD_TAN_THIN_PRISM_FISHEYE")) << ModelNames();
}

TEST(GroundSamplingDistance, IsHeightOverFocalLength) {
  const Camera camera{CameraModel::kSimplePinhole, 4000, 3000, {2000.0, 2000.0, 1500.0}};
  EXPECT_DOUBLE_EQ(GroundSamplingDistance(camera, 100.0), 0.05);
  EXPECT_DOUBLE_EQ(GroundSamplingDistance(camera.Resized(1000, 750), 100.0), 0.2);
}

}  // namespace
}  // namespace skyquilt::camera
