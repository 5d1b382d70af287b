// FOV and the fisheyes of COLMAP 3.12 against its formulas (src/colmap/sensor/models.h), written out here in double precision.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/camera/camera.h"
#include "core/camera/distortion.h"

namespace skyquilt::camera {
namespace {

constexpr std::array kLenses = {CameraModel::kFov, CameraModel::kSimpleRadialFisheye, CameraModel::kRadialFisheye, CameraModel::kThinPrismFisheye,
                                CameraModel::kRadTanThinPrismFisheye};
constexpr double kLargestAngle = 85.0 * std::numbers::pi / 180.0;

// Pixel of a direction with z > 0 as COLMAP computes it.
Eigen::Vector2d ColmapPixel(const Camera& camera, const Eigen::Vector3d& direction) {
  const std::vector<double>& p = camera.params;
  const double u = direction.x() / direction.z(), v = direction.y() / direction.z();
  const double r = std::sqrt(u * u + v * v);
  if (camera.model == CameraModel::kFov) {
    const double omega = p[4];
    const double factor = r == 0.0 ? 2.0 * std::tan(omega / 2.0) / omega : std::atan(r * 2.0 * std::tan(omega / 2.0)) / (r * omega);
    return {p[0] * u * factor + p[2], p[1] * v * factor + p[3]};
  }
  const double theta = std::atan(r);
  const double uu = r == 0.0 ? u : theta * u / r, vv = r == 0.0 ? v : theta * v / r;
  const double t2 = uu * uu + vv * vv, t4 = t2 * t2, t6 = t4 * t2, t8 = t4 * t4;
  switch (camera.model) {
    case CameraModel::kSimpleRadialFisheye:
      return {p[0] * (uu + uu * p[3] * t2) + p[1], p[0] * (vv + vv * p[3] * t2) + p[2]};
    case CameraModel::kRadialFisheye: {
      const double radial = p[3] * t2 + p[4] * t4;
      return {p[0] * (uu + uu * radial) + p[1], p[0] * (vv + vv * radial) + p[2]};
    }
    case CameraModel::kThinPrismFisheye: {
      const double k1 = p[4], k2 = p[5], p1 = p[6], p2 = p[7], k3 = p[8], k4 = p[9], sx1 = p[10], sy1 = p[11];
      const double radial = k1 * t2 + k2 * t4 + k3 * t6 + k4 * t8;
      const double du = uu * radial + 2.0 * p1 * uu * vv + p2 * (t2 + 2.0 * uu * uu) + sx1 * t2;
      const double dv = vv * radial + 2.0 * p2 * uu * vv + p1 * (t2 + 2.0 * vv * vv) + sy1 * t2;
      return {p[0] * (uu + du) + p[2], p[1] * (vv + dv) + p[3]};
    }
    default: {
      double radial = 1.0, power = 1.0;
      for (size_t i = 4; i < 10; ++i) {
        power *= t2;
        radial += p[i] * power;
      }
      const double x = radial * uu, y = radial * vv, r2 = x * x + y * y, r4 = r2 * r2;
      const double p0 = p[10], p1 = p[11];
      const double dx = 2.0 * p1 * x * y + p0 * (r2 + 2.0 * x * x) + p[12] * r2 + p[13] * r4;
      const double dy = 2.0 * p0 * x * y + p1 * (r2 + 2.0 * y * y) + p[14] * r2 + p[15] * r4;
      return {p[0] * (x + dx) + p[2], p[1] * (y + dy) + p[3]};
    }
  }
}

double Between(double low, double high) {
  const int share = *rc::gen::inRange(0, 1000001);
  return low + (high - low) * share / 1e6;
}

// Coefficients small enough for the radius to grow as far as 85 degrees: the sum of (2 i + 1) |k_i| theta^(2 i) is at most 0.7 there, and the shift
// changes the radius by at most 0.15 of itself.
Camera AnyLens(CameraModel model) {
  Camera camera{model, 3000, 2000, {}};
  const double focal = Between(300.0, 3000.0);
  camera.params = HasOneFocalLength(model) ? std::vector<double>{focal, Between(1400.0, 1600.0), Between(900.0, 1100.0)}
                                           : std::vector<double>{focal, focal * Between(0.95, 1.05), Between(1400.0, 1600.0), Between(900.0, 1100.0)};
  const auto add_radial = [&](int n, int first) {
    for (int i = first; i < first + n; ++i) {
      const double most = 0.7 / 6.0 / (2 * i + 1) / std::pow(kLargestAngle, 2 * i);
      camera.params.push_back(Between(-most, most));
    }
  };
  const auto add_shift = [&](int n, double most) {
    for (int i = 0; i < n; ++i) camera.params.push_back(Between(-most, most));
  };
  switch (model) {
    case CameraModel::kFov:
      camera.params.push_back(Between(0.02, 2.0));
      break;
    case CameraModel::kSimpleRadialFisheye:
      add_radial(1, 1);
      break;
    case CameraModel::kRadialFisheye:
      add_radial(2, 1);
      break;
    case CameraModel::kThinPrismFisheye:
      add_radial(2, 1);
      add_shift(2, 3e-3);
      add_radial(2, 3);
      add_shift(2, 3e-3);
      break;
    default:
      add_radial(6, 1);
      add_shift(2, 3e-3);
      add_shift(4, 1e-3);
  }
  return camera;
}

Eigen::Vector3d Direction(double angle, double azimuth) {
  return {std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)};
}

RC_GTEST_PROP(ColmapLenses, ProjectAsColmapDoes, ()) {
  for (const CameraModel model : kLenses) {
    const Camera camera = AnyLens(model);
    RC_ASSERT(camera.Problem() == "");
    const double angle = Between(0.0, kLargestAngle), azimuth = Between(0.0, 2.0 * std::numbers::pi), distance = Between(0.1, 500.0);
    const Eigen::Vector3d direction = Direction(angle, azimuth);
    const auto pixel = camera.ImgFromCam(distance * direction);
    RC_ASSERT(pixel.has_value());
    const Eigen::Vector2d expected = ColmapPixel(camera, direction);
    const double error = (*pixel - expected).norm();
    RC_ASSERT(error <= 1e-9 * (1.0 + expected.norm()));
  }
}

RC_GTEST_PROP(ColmapLenses, EveryDirectionComesBack, ()) {
  for (const CameraModel model : kLenses) {
    const Camera camera = AnyLens(model);
    const double angle = Between(0.0, kLargestAngle), azimuth = Between(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector3d direction = Direction(angle, azimuth);
    const Eigen::Vector3d back = camera.RayFromImg(ColmapPixel(camera, direction));
    // Far from the axis FOV's radius hardly grows: an error of 1e-15 of the radius is one of 1e-13 of the angle there.
    const double error = (back - direction).norm();
    RC_ASSERT(error <= 1e-9);
  }
}

RC_GTEST_PROP(ColmapLenses, HaveTheDerivativesOfTheirValue, ()) {
  for (const CameraModel model : kLenses) {
    const Distortion lens = DistortionOf(AnyLens(model));
    // FOV's plane is that of the tangent.
    const double radius = Between(0.0, model == CameraModel::kFov ? 5.0 : kLargestAngle), azimuth = Between(0.0, 2.0 * std::numbers::pi);
    const Eigen::Vector2d at(radius * std::cos(azimuth), radius * std::sin(azimuth));
    Eigen::Matrix2d jacobian;
    lens.DistortPlane(at, &jacobian);
    for (const double step : {1e-4, 1e-5}) {
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d change = step * Eigen::Vector2d::Unit(axis);
        const Eigen::Vector2d slope = (lens.DistortPlane(at + change, nullptr) - lens.DistortPlane(at - change, nullptr)) / (2.0 * step);
        const double error = (jacobian.col(axis) - slope).norm();
        RC_ASSERT(error <= 2e-7);
      }
    }
  }
}

TEST(ColmapLenses, FovIsSmoothWhereItsFormulaEnds) {
  // On both sides of the radius where the slope's series begins, at the centre, and without distortion.
  for (const double omega : {1e-9, 1e-4, 0.0099, 0.0101, 0.9, -0.9}) {
    const Camera camera{CameraModel::kFov, 2000, 2000, {1000.0, 1000.0, 1000.0, 1000.0, omega}};
    const double a = 2.0 * std::tan(0.5 * omega);
    for (const double r : {0.0, 1e-9, 1e-3, 0.9999e-2 / std::abs(a), 1.0001e-2 / std::abs(a), 0.5, 3.0}) {
      if (r > 50.0) continue;
      const auto pixel = camera.ImgFromCam({r, 0.0, 1.0});
      ASSERT_TRUE(pixel);
      const double expected = r == 0.0 ? 0.0 : std::atan(a * r) / omega;
      EXPECT_NEAR(pixel->x(), 1000.0 + 1000.0 * expected, 1e-9) << omega << " at " << r;
      EXPECT_LT((camera.RayFromImg(*pixel) - Eigen::Vector3d(r, 0.0, 1.0).normalized()).norm(), 1e-12) << omega << " at " << r;
      Eigen::Matrix2d jacobian;
      Distortion::FieldOfView(omega).DistortPlane({r, 0.0}, &jacobian);
      EXPECT_NEAR(jacobian(0, 0), a / omega / (1.0 + a * a * r * r), 1e-11) << omega << " at " << r;
      EXPECT_NEAR(jacobian(1, 1), r == 0.0 ? a / omega : expected / r, 1e-11) << omega << " at " << r;
    }
  }
  const Camera straight{CameraModel::kFov, 2000, 2000, {1000.0, 1000.0, 1000.0, 1000.0, 0.0}};
  EXPECT_EQ(*straight.ImgFromCam({0.3, -0.2, 1.0}), Eigen::Vector2d(1300.0, 800.0));
}

TEST(ColmapLenses, BeyondTheLargestRadiusTheNearestDirectionIsGiven) {
  // No direction has a distorted radius above pi / (2 omega).
  const Camera fov{CameraModel::kFov, 2000, 2000, {1000.0, 1000.0, 1000.0, 1000.0, 1.2}};
  for (const double radius_px : {1310.0, 2000.0, 1e7}) {
    const Eigen::Vector3d ray = fov.RayFromImg({1000.0 + radius_px, 1000.0});
    EXPECT_NEAR(ray.x() / ray.z(), 100.0, 1e-6) << radius_px;
  }
  // theta - 0.2 theta^3 folds at theta = sqrt(1 / 0.6).
  const Camera fisheye{CameraModel::kSimpleRadialFisheye, 2000, 2000, {1000.0, 1000.0, 1000.0, -0.2}};
  const double fold = std::sqrt(1.0 / 0.6);
  EXPECT_TRUE(fisheye.ImgFromCam(Direction(0.999 * fold, 0.0)));
  EXPECT_FALSE(fisheye.ImgFromCam(Direction(1.001 * fold, 0.0)));
  EXPECT_LT((fisheye.RayFromImg({1000.0 + 900.0, 1000.0}) - Direction(fold, 0.0)).norm(), 1e-5);
}

TEST(ColmapLenses, ResizedToAnotherAspectAreTheSameLens) {
  const Camera camera{CameraModel::kRadialFisheye, 1000, 800, {500.0, 510.0, 390.0, 0.02, -0.01}};
  const Camera wide = camera.Resized(2001, 1600);
  EXPECT_EQ(wide.model, CameraModel::kOpencvFisheye);
  const Eigen::Vector3d ray = camera.RayFromImg({900.0, 100.0});
  EXPECT_LT((wide.RayFromImg({900.0 * 2.001, 200.0}) - ray).norm(), 1e-12);
}

}  // namespace
}  // namespace skyquilt::camera
