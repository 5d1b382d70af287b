#include "prepare/georeference/checks/horizontal_lines.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/image/image.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180.0;
const double kSteepestView = std::cos(40.0 * kDegree);
// Farther from straight down than the first, a line whose plane is within the second of vertical may be a vertical edge.
const double kNearNadir = std::cos(10.0 * kDegree), kNearVertical = std::sin(3.0 * kDegree);

std::optional<HorizontalLine> OnTheGround(const Vector3d& origin, const Vector3d& from, const Vector3d& to, double ground_z) {
  const Vector3d middle = (from + to).normalized();
  if (-middle.z() < kSteepestView) return std::nullopt;
  const Vector3d normal = from.cross(to).normalized();
  if (-middle.z() < kNearNadir && std::abs(normal.z()) < kNearVertical) return std::nullopt;
  const Vector3d along = normal.cross(Vector3d::UnitZ());
  const double height = origin.z() - ground_z;
  if (!(height > 0.0) || !(along.norm() > 1e-6)) return std::nullopt;
  const auto hit = [&](const Vector3d& ray) -> Vector2d { return (origin + ray * (height / -ray.z())).head<2>(); };
  HorizontalLine line;
  line.yaw_deg = std::atan2(along.y(), along.x()) / kDegree;
  line.length_m = (hit(to) - hit(from)).norm();
  line.place_enu = hit(middle);
  if (!std::isfinite(line.length_m)) return std::nullopt;
  return line;
}

std::vector<HorizontalLine> LinesOf(const survey::Survey& survey, const survey::Photo& photo, double ground_z) {
  image::Image8 rgb = image::LoadRgb8(survey.photo_root / photo.name);
  const int width = std::min(kLinePhotoWidth, rgb.width);
  if (width < rgb.width) rgb = image::Resize(rgb, width, image::ScaledHeight(rgb.width, rgb.height, width));
  cv::Mat grey;
  cv::cvtColor(cv::Mat(rgb.height, rgb.width, CV_8UC3, rgb.data.data()), grey, cv::COLOR_RGB2GRAY);
  std::vector<cv::Vec4f> segments;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(grey, segments);
  const camera::Camera camera = survey.cameras[static_cast<size_t>(photo.camera)].Resized(rgb.width, rgb.height);
  const geo::Rigid3d enu_from_cam = photo.cam_from_enu.Inverse();
  std::vector<HorizontalLine> lines;
  for (const cv::Vec4f& s : segments) {
    // OpenCV's pixel centres are at whole numbers.
    const Vector2d from(static_cast<double>(s[0]) + 0.5, static_cast<double>(s[1]) + 0.5),
        to(static_cast<double>(s[2]) + 0.5, static_cast<double>(s[3]) + 0.5);
    if ((to - from).norm() < kShortestLinePx) continue;
    const Vector3d from_ray = enu_from_cam.rotation * camera.RayFromImg(from), to_ray = enu_from_cam.rotation * camera.RayFromImg(to);
    if (const auto line = OnTheGround(enu_from_cam.translation, from_ray, to_ray, ground_z)) lines.push_back(*line);
  }
  return lines;
}

// Evenly among the training photos: the directions may guide training.
std::vector<const survey::Photo*> ChoosePhotos(const survey::Survey& survey) {
  std::vector<const survey::Photo*> training;
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) training.push_back(&photo);
  }
  const size_t n = std::min<size_t>(kLinePhotos, training.size());
  std::vector<const survey::Photo*> chosen;
  for (size_t i = 0; i < n; ++i) chosen.push_back(training[i * training.size() / n]);
  return chosen;
}

}  // namespace

FoundLines FindHorizontalLines(const survey::Survey& survey, base::ThreadPool& threads) {
  FoundLines found;
  const std::vector<const survey::Photo*> chosen = ChoosePhotos(survey);
  if (survey.points.empty() || chosen.empty()) return found;
  std::vector<double> heights;
  heights.reserve(survey.points.size());
  for (const survey::SparsePoint& point : survey.points) heights.push_back(point.x_in_enu.z());
  std::nth_element(heights.begin(), heights.begin() + static_cast<ptrdiff_t>(heights.size() / 2), heights.end());
  const double ground_z = heights[heights.size() / 2];
  std::vector<std::vector<HorizontalLine>> of_photo(chosen.size());
  std::vector<char> read(chosen.size(), 0);
  threads.ParallelFor(static_cast<int64_t>(chosen.size()), [&](int64_t task, int) {
    if (base::CancelRequested()) return;
    const auto i = static_cast<size_t>(task);
    const survey::Photo& photo = *chosen[i];
    try {
      of_photo[i] = LinesOf(survey, photo, ground_z);
      read[i] = 1;
    } catch (const base::InputError& error) {
      base::LogWarning("no lines are searched in {}: {}", photo.name, error.finding());
    }
  });
  base::ThrowIfCancelled();
  for (size_t i = 0; i < chosen.size(); ++i) {
    found.photos += read[i];
    found.lines.insert(found.lines.end(), of_photo[i].begin(), of_photo[i].end());
  }
  return found;
}

}  // namespace skyquilt::prepare::georeference
