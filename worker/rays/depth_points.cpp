#include "worker/rays/depth_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/camera/pixel_pitch.h"
#include "core/survey/training_points.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

constexpr double kSmallestError_px = 0.5;
constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kLargestUsefulAngle = 45.0 * kRadians;

struct GoodPoint {
  size_t index = 0;
  double sigma_per_pixel = 0.0;  // standard deviation along a ray, divided by the width of a pixel at the point
};

bool InPlan(const Vector3d& x, const geo::BlockBox& box) {
  const Vector3d low = box.TrainMin(), high = box.TrainMax();
  return x.x() >= low.x() && x.y() >= low.y() && x.x() < high.x() && x.y() < high.y();
}

std::vector<GoodPoint> GoodPoints(const survey::Survey& survey, const std::vector<Vector3d>& centres, const geo::BlockBox& box) {
  std::vector<GoodPoint> good;
  std::vector<Vector3d> seen_from;
  for (size_t i = 0; i < survey.points.size(); ++i) {
    const survey::SparsePoint& point = survey.points[i];
    const auto error_px = static_cast<double>(point.error_px);
    if (!InPlan(point.x_in_enu, box) || !(error_px <= kLargestPointError_px)) continue;
    seen_from.clear();
    for (const int32_t photo : survey.tracks.PhotosOf(i)) {
      if (!survey.photos[static_cast<size_t>(photo)].is_test) seen_from.push_back(centres[static_cast<size_t>(photo)]);
    }
    const double angle = TriangulationAngle(point.x_in_enu, seen_from);
    if (angle < kSmallestPointAngle_deg * kRadians) continue;
    good.push_back({i, std::max(error_px, kSmallestError_px) / std::tan(std::min(angle, kLargestUsefulAngle))});
  }
  return good;
}

// Leaves out points by a hash so that about `most` observations remain.
void Thin(const survey::Survey& survey, size_t most, std::vector<GoodPoint>& good) {
  size_t n = 0;
  for (const GoodPoint& point : good) n += survey::CountTrainingPhotos(survey, survey.tracks.PhotosOf(point.index));
  if (n <= most) return;
  const double share = static_cast<double>(most) / static_cast<double>(n);
  std::erase_if(good, [share](const GoodPoint& point) { return static_cast<double>(base::MixBits(point.index) >> 11U) * 0x1.0p-53 >= share; });
}

}  // namespace

double TriangulationAngle(const Vector3d& x_in_enu, const std::vector<Vector3d>& centres_enu) {
  // The chord between unit vectors keeps small angles exact, where a cosine would round them away.
  double longest = 0.0;
  std::vector<Vector3d> directions;
  directions.reserve(centres_enu.size());
  for (const Vector3d& centre : centres_enu) {
    const Vector3d direction = (centre - x_in_enu).normalized();
    for (const Vector3d& other : directions) longest = std::max(longest, (direction - other).squaredNorm());
    directions.push_back(direction);
  }
  return 2.0 * std::asin(std::min(1.0, 0.5 * std::sqrt(longest)));
}

DepthPoints::DepthPoints(const survey::Survey& survey, const RaySource& source, const geo::BlockBox& box, size_t most) {
  if (survey.tracks.Empty()) return;
  std::vector<Vector3d> centres;
  for (const survey::Photo& photo : survey.photos) centres.push_back(photo.cam_from_enu.OriginInSource());
  std::vector<camera::PixelPitch> pitches;
  for (const camera::Camera& camera : survey.cameras) pitches.emplace_back(camera);
  std::vector<GoodPoint> good = GoodPoints(survey, centres, box);
  Thin(survey, most, good);
  for (const GoodPoint& point : good) {
    const Vector3d& x_in_enu = survey.points[point.index].x_in_enu;
    for (const int32_t index : survey.tracks.PhotosOf(point.index)) {
      const survey::Photo& photo = survey.photos[static_cast<size_t>(index)];
      if (photo.is_test) continue;
      const camera::Camera& cached = source.CameraOf(index);
      const auto pixel = cached.ImgFromCam(photo.cam_from_enu * x_in_enu);
      if (!pixel) continue;
      const Eigen::Vector2f at = pixel->cast<float>();  // tested as it is stored: rounding may reach the edge
      if (!(at.minCoeff() >= 0.0F && at.x() < static_cast<float>(cached.width) && at.y() < static_cast<float>(cached.height))) continue;
      const auto camera_index = static_cast<size_t>(photo.camera);
      const camera::Camera& full = survey.cameras[camera_index];
      const Eigen::Vector2d at_full(pixel->x() * full.width / cached.width, pixel->y() * full.height / cached.height);
      const double distance = (x_in_enu - centres[static_cast<size_t>(index)]).norm();
      const double sigma = point.sigma_per_pixel * pitches[camera_index].At(at_full) * distance;
      points_.push_back({index, at.x(), at.y(), static_cast<float>(distance), static_cast<float>(sigma)});
    }
  }
}

}  // namespace skyquilt::worker
