#include "products/camera_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "core/base/errors.h"
#include "core/config/options.h"
#include "core/image/image.h"

namespace skyquilt::products {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kPathFovDeg = 55.0;  // of built-in paths
constexpr double kPhotosPerSecond = 2.0;

geo::Rigid3d PoseFromAxes(const Eigen::Vector3d& eye, const Eigen::Vector3d& right, const Eigen::Vector3d& down, const Eigen::Vector3d& forward) {
  Eigen::Matrix3d cam_from_enu;
  cam_from_enu.row(0) = right.transpose();
  cam_from_enu.row(1) = down.transpose();
  cam_from_enu.row(2) = forward.transpose();
  geo::Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(cam_from_enu).normalized();
  pose.translation = -(pose.rotation * eye);
  return pose;
}

std::string FrameName(size_t index) {
  const std::string digits = std::to_string(index);
  return "frame_" + std::string(digits.size() < 5 ? 5 - digits.size() : 0, '0') + digits;
}

// "flight/a.jpg" -> "flight_a". If that name is taken, the extension is kept.
std::string FileStem(const std::string& photo, std::set<std::string>* taken) {
  std::string name = std::filesystem::path(photo).replace_extension().generic_string();
  std::replace(name.begin(), name.end(), '/', '_');
  if (!taken->insert(name).second) {
    name = photo;
    std::replace(name.begin(), name.end(), '/', '_');
    while (!taken->insert(name).second) name += "_";
  }
  return name;
}

size_t FramesOf(const ProductOptions& options) {
  return static_cast<size_t>(std::max(1L, std::lround(options.video_seconds * options.video_fps)));
}

const survey::Photo& FindPhoto(const survey::Survey& survey, const std::string& name) {
  std::vector<std::string> known;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.name == name) return photo;
    known.push_back(photo.name);
  }
  for (const survey::Photo& photo : survey.photos) {
    if (std::filesystem::path(photo.name).filename() == name) return photo;
  }
  const std::string nearest = config::Nearest(name, known);
  throw base::UsageError("the survey has no photo \"" + name + "\"" + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
}

}  // namespace

geo::Rigid3d PoseFromAngles(const Eigen::Vector3d& eye_enu, double yaw_deg, double pitch_deg, double roll_deg) {
  const double yaw = yaw_deg * kRadPerDeg;
  const double pitch = pitch_deg * kRadPerDeg;
  const double roll = roll_deg * kRadPerDeg;
  const Eigen::Vector3d forward(std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch));
  const Eigen::Vector3d level(std::cos(yaw), -std::sin(yaw), 0.0);
  const Eigen::Vector3d below = forward.cross(level);
  return PoseFromAxes(eye_enu, std::cos(roll) * level + std::sin(roll) * below, std::cos(roll) * below - std::sin(roll) * level, forward);
}

geo::Rigid3d PoseLookingAt(const Eigen::Vector3d& eye_enu, const Eigen::Vector3d& target_enu) {
  const Eigen::Vector3d way = target_enu - eye_enu;
  const double across = way.head<2>().norm();
  const double yaw = across > 1e-9 * way.norm() ? std::atan2(way.x(), way.y()) : 0.0;
  return PoseFromAngles(eye_enu, yaw / kRadPerDeg, std::atan2(way.z(), across) / kRadPerDeg, 0.0);
}

camera::Camera PinholeCamera(int width, int height, double fov_deg) {
  SKYQUILT_CHECK(width > 0 && height > 0 && fov_deg > 0.0 && fov_deg < 180.0, std::to_string(fov_deg));
  camera::Camera camera;
  camera.model = camera::CameraModel::kSimplePinhole;
  camera.width = width;
  camera.height = height;
  camera.params = {0.5 * width / std::tan(0.5 * fov_deg * kRadPerDeg), 0.5 * width, 0.5 * height};
  return camera;
}

double FovAcrossWidth(double fovy_deg, int width, int height) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  return 2.0 * std::atan(std::tan(0.5 * fovy_deg / kDegPerRad) * width / height) * kDegPerRad;
}

std::vector<View> ViewsOfPhotos(const survey::Survey& survey, const std::vector<std::string>& names, int width) {
  if (width < 0) throw base::UsageError("width = " + std::to_string(width) + " is not allowed: it must be positive, or 0 for the size of the photo");
  std::vector<const survey::Photo*> photos;
  for (const std::string& name : names) photos.push_back(&FindPhoto(survey, name));
  if (names.empty()) {
    for (const survey::Photo& photo : survey.photos) {
      if (photo.is_test) photos.push_back(&photo);
    }
    if (photos.empty()) throw base::UsageError("the survey has no held-out photos; name the photos whose views to render");
  }
  std::vector<View> views;
  std::set<std::string> taken;
  for (const survey::Photo* photo : photos) {
    const camera::Camera& camera = survey.cameras.at(static_cast<size_t>(photo->camera));
    const bool resize = width > 0 && width != camera.width;
    views.push_back({FileStem(photo->name, &taken), resize ? camera.Resized(width, image::ScaledHeight(camera.width, camera.height, width)) : camera,
                     photo->cam_from_enu});
  }
  return views;
}

Eigen::Vector3d CatmullRom(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, const Eigen::Vector3d& d, double u) {
  return 0.5 * (2.0 * b + u * (c - a) + u * u * (2.0 * a - 5.0 * b + 4.0 * c - d) + u * u * u * (3.0 * b - 3.0 * c + d - a));
}

std::vector<View> PathAlongCameras(const survey::Survey& survey, const ProductOptions& options) {
  options.Check();
  std::vector<const survey::Photo*> photos;
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) photos.push_back(&photo);
  }
  SKYQUILT_CHECK(!photos.empty(), "a path along no photos");
  if (std::all_of(photos.begin(), photos.end(), [](const survey::Photo* photo) { return photo->time_s.has_value(); })) {
    std::stable_sort(photos.begin(), photos.end(), [](const survey::Photo* a, const survey::Photo* b) { return *a->time_s < *b->time_s; });
  }
  const size_t frames = FramesOf(options);
  const size_t wanted = static_cast<size_t>(std::max(2L, std::lround(kPhotosPerSecond * options.video_seconds)));
  const size_t keys = std::min(wanted, photos.size());
  std::vector<Eigen::Vector3d> eyes, forwards;
  for (size_t k = 0; k < keys; ++k) {
    const geo::Rigid3d& pose = photos[keys == 1 ? 0 : k * (photos.size() - 1) / (keys - 1)]->cam_from_enu;
    eyes.push_back(pose.OriginInSource());
    forwards.push_back(pose.rotation.conjugate() * Eigen::Vector3d::UnitZ());
  }
  std::vector<View> views;
  for (size_t i = 0; i < frames; ++i) {
    const double along = frames == 1 ? 0.0 : static_cast<double>((keys - 1) * i) / static_cast<double>(frames - 1);
    const size_t k = std::min(static_cast<size_t>(along), keys - 1), next = std::min(k + 1, keys - 1);
    const double u = along - static_cast<double>(k);
    const Eigen::Vector3d eye = CatmullRom(eyes[k == 0 ? 0 : k - 1], eyes[k], eyes[next], eyes[std::min(k + 2, keys - 1)], u);
    Eigen::Vector3d forward = (1.0 - u) * forwards[k] + u * forwards[next];
    if (!(forward.norm() > 1e-3)) forward = forwards[k];  // halfway between opposite views
    views.push_back({FrameName(i), PinholeCamera(options.video_width, options.video_height, kPathFovDeg), PoseLookingAt(eye, eye + forward)});
  }
  return views;
}

std::vector<View> BuiltInPath(const scene::SceneInfo& info, const ProductOptions& options) {
  options.Check();
  constexpr double kDownDeg = 50.0;
  const camera::Camera camera = PinholeCamera(options.video_width, options.video_height, kPathFovDeg);
  const size_t frames = FramesOf(options);
  const Eigen::Vector3d extent = info.max_enu - info.min_enu;
  Eigen::Vector3d centre = 0.5 * (info.min_enu + info.max_enu);
  // Aim at the lower third of the height range, where ground and low roofs are.
  centre.z() = info.min_enu.z() + extent.z() / 3.0;
  const double reach = 0.5 * extent.head<2>().minCoeff();
  std::vector<View> views;
  for (size_t i = 0; i < frames; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(frames);
    View view;
    view.name = FrameName(i);
    view.camera = camera;
    if (options.video_path == "orbit") {
      const double clearance = (info.max_enu.z() - centre.z()) / std::sin(kDownDeg * kRadPerDeg);
      const double distance = std::max(1.8 * reach, 1.3 * clearance);
      const double azimuth = 2.0 * std::numbers::pi * share;
      const double flat = distance * std::cos(kDownDeg * kRadPerDeg);
      const Eigen::Vector3d offset(-flat * std::sin(azimuth), -flat * std::cos(azimuth), distance * std::sin(kDownDeg * kRadPerDeg));
      view.cam_from_enu = PoseLookingAt(centre + offset, centre);
    } else {
      const double height = std::max(reach, 1.5 * (info.max_enu.z() - centre.z()));
      const Eigen::Vector3d ahead = Eigen::Vector3d(extent.x(), extent.y(), 0.0).normalized();
      const Eigen::Vector3d eye = centre + ahead * (-1.1 + 1.6 * share) * reach + Eigen::Vector3d(0.0, 0.0, height);
      view.cam_from_enu = PoseLookingAt(eye, eye + ahead * 0.7 * height - Eigen::Vector3d(0.0, 0.0, height));
    }
    views.push_back(view);
  }
  return views;
}

}  // namespace skyquilt::products
