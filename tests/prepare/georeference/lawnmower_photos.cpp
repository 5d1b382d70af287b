#include "tests/prepare/georeference/lawnmower_photos.h"

#include <cmath>
#include <numbers>

namespace skyquilt::test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double kRadians = std::numbers::pi / 180.0;

}  // namespace

Eigen::Quaterniond CamFromEnu(const Attitude& attitude) {
  // Aircraft: x forward, y right, z down.
  const Eigen::Quaterniond ned_from_body = AngleAxisd(attitude.yaw_deg * kRadians, Vector3d::UnitZ()) *
                                           AngleAxisd(attitude.pitch_deg * kRadians, Vector3d::UnitY()) *
                                           AngleAxisd(attitude.roll_deg * kRadians, Vector3d::UnitX());
  Eigen::Matrix3d cam_from_body, ned_from_enu;
  cam_from_body << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0;
  ned_from_enu << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  return Eigen::Quaterniond(Eigen::Matrix3d(cam_from_body * ned_from_body.conjugate().toRotationMatrix() * ned_from_enu));
}

geo::Similarity3d RandomFrame(base::Random& random) {
  const Eigen::Quaterniond rotation{random.Normal(), random.Normal(), random.Normal(), random.Normal()};
  return {std::exp(random.Uniform(-3.0, 3.0)), rotation.normalized(), Vector3d{random.Normal(), random.Normal(), random.Normal()}};
}

prepare::input::PreparedPhoto PreparedAt(const Vector3d& centre_in_enu, const Attitude& attitude, const geo::Similarity3d& model_from_enu) {
  prepare::input::PreparedPhoto photo;
  const Eigen::Quaterniond rotation = CamFromEnu(attitude);
  photo.cam_from_model = geo::TransformCameraWorld({rotation, -(rotation * centre_in_enu)}, model_from_enu);
  return photo;
}

Eigen::Quaterniond SmallRotation(double sigma_deg, base::Random& random) {
  const Vector3d axis{random.Normal(), random.Normal(), random.Normal()};
  return Eigen::Quaterniond(AngleAxisd(axis.norm() * sigma_deg * kRadians, axis.normalized()));
}

Vector3d OnLawnmower(int photo, int n_photos) {
  constexpr double kStep_m = 15.0;
  const int line = photo / kLine, along = line % 2 == 0 ? photo % kLine : kLine - 1 - photo % kLine;
  const int n_lines = n_photos / kLine;
  const double middle = 0.5 * (n_lines - 1);
  return {kStep_m * (line - middle), kStep_m * (along - 0.5 * (kLine - 1)), 60.0};
}

std::vector<prepare::input::PreparedPhoto> LawnmowerPhotos(int n_photos, const geo::Similarity3d& model_from_enu) {
  std::vector<prepare::input::PreparedPhoto> photos;
  photos.reserve(static_cast<size_t>(n_photos));
  for (int i = 0; i < n_photos; ++i) {
    const double yaw_deg = (i / kLine) % 2 == 0 ? 0.0 : 180.0;
    photos.push_back(PreparedAt(OnLawnmower(i, n_photos), {.yaw_deg = yaw_deg}, model_from_enu));
    photos.back().file.tags.capture_time_s = 1e9 + kPhotoInterval_s * i;
  }
  return photos;
}

double AngleDeg(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadians;
}

}  // namespace skyquilt::test
