#include "surface/views/view_poses.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/survey/seen_distance.h"

namespace skyquilt::surface {
namespace {

constexpr double kMaxAngleRad = 55.0 * std::numbers::pi / 180.0;
constexpr int kBorderSamples = 65;  // per side; odd, so that the middle is one

// Position on the plane in front of the camera; rays beside or behind the camera limit nothing.
Eigen::Vector2d OnTangentPlane(const camera::Camera& camera, double x, double y, const Eigen::Vector2d& unlimited) {
  const Eigen::Vector3d ray = camera.RayFromImg({x, y});
  if (!(ray.z() > 1e-6)) return unlimited;
  return {ray.x() / ray.z(), ray.y() / ray.z()};
}

// Whether the border of the rectangle projects into the photo.
bool LiesInside(const TangentRectangle& r, const camera::Camera& camera) {
  const auto seen = [&](double x, double y) {
    const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam({x, y, 1.0});
    // The inversion of the distortion leaves errors of this size on the border itself.
    constexpr double kSlack = 1e-3;
    return pixel && pixel->x() >= -kSlack && pixel->y() >= -kSlack && pixel->x() <= camera.width + kSlack && pixel->y() <= camera.height + kSlack;
  };
  for (int i = 0; i < kBorderSamples; ++i) {
    const double share = static_cast<double>(i) / (kBorderSamples - 1);
    const double x = r.left + share * r.Width(), y = r.top + share * r.Height();
    if (!seen(x, r.top) || !seen(x, r.bottom) || !seen(r.left, y) || !seen(r.right, y)) return false;
  }
  return true;
}

// Pixels per unit of the tangent plane.
double FocalOf(const TangentRectangle& rectangle, const camera::Camera& camera, double wanted_px) {
  double focal = std::max(camera.FocalX(), camera.FocalY());
  if (std::isfinite(wanted_px) && wanted_px > 0.0) focal = std::min(focal, wanted_px);
  return std::min({focal, camera.width / rectangle.Width(), camera.height / rectangle.Height()});
}

double WithinLimits(const TangentRectangle& rectangle, double focal_px) {
  const double at_least = std::max(focal_px, kLeastViewWidth / std::min(rectangle.Width(), rectangle.Height()));
  return std::min(at_least, std::sqrt(kMaxViewPixels / (rectangle.Width() * rectangle.Height())));
}

double HeightAboveGround(const survey::Photo& photo, double median_agl_m, const scene::SceneInfo& info) {
  const double above_box = photo.cam_from_enu.OriginInSource().z() - info.min_enu.z();
  for (const double height : {photo.agl_m, median_agl_m, above_box, info.max_enu.z() - info.min_enu.z()}) {
    if (std::isfinite(height) && height > 0.0) return height;
  }
  return 1.0;
}

// Metres; NaN when no training photo has one.
double MedianAgl(const survey::Survey& survey) {
  std::vector<double> known;
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test && std::isfinite(photo.agl_m)) known.push_back(photo.agl_m);
  }
  return base::Median(std::move(known));
}

}  // namespace

std::optional<TangentRectangle> InnerRectangle(const camera::Camera& camera) {
  if (!camera.Problem().empty()) return std::nullopt;
  const double limit = std::tan(kMaxAngleRad);
  TangentRectangle r{-limit, limit, -limit, limit};
  const double width = camera.width, height = camera.height;
  for (int i = 0; i < kBorderSamples; ++i) {
    const double share = static_cast<double>(i) / (kBorderSamples - 1);
    const double x = share * width, y = share * height;
    r.left = std::max(r.left, OnTangentPlane(camera, 0.0, y, {-limit, 0.0}).x());
    r.right = std::min(r.right, OnTangentPlane(camera, width, y, {limit, 0.0}).x());
    r.top = std::max(r.top, OnTangentPlane(camera, x, 0.0, {0.0, -limit}).y());
    r.bottom = std::min(r.bottom, OnTangentPlane(camera, x, height, {0.0, limit}).y());
  }
  // The borders of lenses whose distortion cannot be inverted there are only nearly right.
  constexpr int kMaxSteps = 200;
  constexpr double kShrink = 0.98;
  for (int step = 0; step < kMaxSteps; ++step) {
    if (!(r.Width() > 1e-6 && r.Height() > 1e-6)) return std::nullopt;
    if (LiesInside(r, camera)) return r;
    // Towards the optical axis, where distortion is least; it need not be in the middle.
    const double x = std::clamp(0.0, r.left, r.right), y = std::clamp(0.0, r.top, r.bottom);
    r = {x + kShrink * (r.left - x), x + kShrink * (r.right - x), y + kShrink * (r.top - y), y + kShrink * (r.bottom - y)};
  }
  return std::nullopt;
}

ViewPose PinholeOf(const TangentRectangle& rectangle, double focal_px, const geo::Rigid3d& cam_from_enu) {
  const double width = rectangle.Width() * focal_px, height = rectangle.Height() * focal_px;
  ViewPose pose;
  // Products that should be whole may end just below.
  pose.width = std::max(1, static_cast<int>(std::floor(width + 1e-6)));
  pose.height = std::max(1, static_cast<int>(std::floor(height + 1e-6)));
  pose.focal_px = focal_px;
  pose.cx = -rectangle.left * focal_px - 0.5 * (width - pose.width);
  pose.cy = -rectangle.top * focal_px - 0.5 * (height - pose.height);
  pose.cam_from_enu = cam_from_enu;
  return pose;
}

PhotoPlaces PlacesOfPhotos(const SurfaceInput& input) {
  const survey::Survey& survey = *input.survey;
  std::vector<std::optional<TangentRectangle>> rectangles;
  rectangles.reserve(survey.cameras.size());
  for (const camera::Camera& camera : survey.cameras) rectangles.push_back(InnerRectangle(camera));

  PhotoPlaces places;
  std::vector<double> distances;
  const double median_agl_m = MedianAgl(survey);
  const std::vector<std::optional<survey::SeenDistance>> seen = survey::DistancesOfLevelPhotos(survey);
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    if (photo.is_test) continue;
    const auto camera = static_cast<size_t>(photo.camera);
    if (photo.camera < 0 || camera >= rectangles.size() || !rectangles[camera]) {
      base::LogWarning("surface: the camera of photo {} cannot be used for a picture of depth; it is left out", photo.name);
      continue;
    }
    const TangentRectangle& rectangle = *rectangles[camera];
    const double distance_m = seen[i] ? seen[i]->median_m : HeightAboveGround(photo, median_agl_m, *input.info);
    const double focal = FocalOf(rectangle, survey.cameras[camera], distance_m / (input.options.view_gsd * input.info->gsd_m));
    places.training.push_back(PinholeOf(rectangle, WithinLimits(rectangle, focal), photo.cam_from_enu));
    places.training.back().photo = static_cast<int>(i);
    distances.push_back(distance_m);
  }
  if (!distances.empty()) places.agl_m = base::UpperMedian(distances);
  return places;
}

}  // namespace skyquilt::surface
