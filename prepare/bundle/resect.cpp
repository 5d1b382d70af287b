#include "prepare/bundle/resect.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>

#include "core/base/cancel.h"
#include "core/linear/linear.h"

namespace skyquilt::prepare::bundle {
namespace {

bool Resect(BundleProblem& bundle, uint32_t index, const std::vector<uint32_t>& entries, const std::vector<uint32_t>& track_of, double threshold) {
  BundlePhoto& photo = bundle.photos[index];
  const BundleLens& lens = bundle.lenses[static_cast<size_t>(photo.lens)];
  const camera::Camera camera = CameraOf(lens.numbers, lens.camera);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> places;
  for (const uint32_t e : entries) {
    const uint32_t t = track_of[e];
    if (bundle.has_point[t] == 0) continue;
    const Eigen::Vector3d ray = camera.RayFromImg(bundle.pixel[e]);
    constexpr double kLeastDepth = 0.1;
    if (ray.z() < kLeastDepth) continue;
    points.emplace_back(bundle.point[t].x(), bundle.point[t].y(), bundle.point[t].z());
    places.emplace_back(ray.x() / ray.z(), ray.y() / ray.z());
  }
  if (points.size() < kLeastObservations) return false;
  cv::Mat turn, shift, inliers;
  const double focal_units = lens.numbers[0] / lens.unit_px;
  // OpenCV's RANSAC starts from the same random state at every call.
  constexpr int kTries = 500;
  constexpr double kConfidence = 0.999;
  try {
    if (!cv::solvePnPRansac(points, places, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turn, shift, false, kTries,
                            static_cast<float>(threshold / focal_units), kConfidence, inliers, cv::SOLVEPNP_AP3P)) {
      return false;
    }
    if (inliers.rows < static_cast<int>(kLeastObservations)) return false;
    std::vector<cv::Point3d> good_points;
    std::vector<cv::Point2d> good_places;
    for (int k = 0; k < inliers.rows; ++k) {
      good_points.push_back(points[static_cast<size_t>(inliers.at<int>(k))]);
      good_places.push_back(places[static_cast<size_t>(inliers.at<int>(k))]);
    }
    cv::solvePnPRefineLM(good_points, good_places, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turn, shift);
  } catch (const cv::Exception&) {
    return false;  // points that determine no pose
  }
  cv::Mat rotation_cv;
  cv::Rodrigues(turn, rotation_cv);
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  cv::cv2eigen(rotation_cv, rotation);
  cv::cv2eigen(shift, translation);
  if (!rotation.allFinite() || !translation.allFinite()) return false;
  photo.cam_from_enu = Eigen::Quaterniond(rotation).normalized();
  photo.centre = -(photo.cam_from_enu.conjugate() * translation);
  photo.placed = true;
  return true;
}

Eigen::Matrix3d CrossProduct(const Eigen::Vector3d& a) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

// Change of a photo's pose by the errors of entries within the threshold: turn of the camera in its own frame, shift of its centre. Large errors
// count as in the bundle adjustment.
Eigen::VectorXd PoseChange(const BundleProblem& bundle, const BundlePhoto& photo, const std::vector<uint32_t>& entries,
                           const std::vector<uint32_t>& track_of, double threshold) {
  constexpr double kGentle = 2.5;
  const BundleLens& lens = bundle.lenses[static_cast<size_t>(photo.lens)];
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(6, 6);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(6);
  for (const uint32_t e : entries) {
    const uint32_t t = track_of[e];
    const double error = bundle.has_point[t] != 0 ? bundle.Error(e, bundle.point[t]) : -1.0;
    if (error < 0.0 || error > threshold) continue;
    const Eigen::Vector3d x_in_cam = photo.cam_from_enu * (bundle.point[t] - photo.centre);
    LensJacobian jacobian;
    const Eigen::Vector2d residual = (Project(lens.numbers, x_in_cam, &jacobian) - bundle.pixel[e]) / lens.unit_px;
    Eigen::Matrix<double, 2, 6> by_pose;
    by_pose << -jacobian.by_point * CrossProduct(x_in_cam), -jacobian.by_point * photo.cam_from_enu.toRotationMatrix();
    by_pose /= lens.unit_px;
    const double weight = kGentle / std::max(kGentle, error);
    normal += weight * by_pose.transpose().lazyProduct(by_pose);
    gradient += weight * by_pose.transpose().lazyProduct(residual);
  }
  return -linear::SolvePositive(normal, gradient);
}

}  // namespace

std::vector<std::vector<uint32_t>> EntriesOfPhotos(const BundleProblem& bundle) {
  std::vector<std::vector<uint32_t>> entries(bundle.photos.size());
  for (uint32_t e = 0; e < bundle.tracks.entries.size(); ++e) entries[bundle.tracks.entries[e].photo].push_back(e);
  return entries;
}

std::vector<uint32_t> TrackOfEntries(const FeatureTracks& tracks) {
  std::vector<uint32_t> track_of(tracks.entries.size());
  for (uint32_t t = 0; t < tracks.size(); ++t) {
    for (uint32_t e = tracks.first[t]; e < tracks.first[t + 1]; ++e) track_of[e] = t;
  }
  return track_of;
}

size_t ResectPhotos(BundleProblem& bundle, double threshold) {
  const std::vector<std::vector<uint32_t>> entries = EntriesOfPhotos(bundle);
  const std::vector<uint32_t> track_of = TrackOfEntries(bundle.tracks);
  size_t n = 0;
  for (uint32_t i = 0; i < bundle.photos.size(); ++i) {
    if (bundle.photos[i].placed) continue;
    base::ThrowIfCancelled();
    n += Resect(bundle, i, entries[i], track_of, threshold) ? 1 : 0;
  }
  return n;
}

size_t RefineByPoints(BundleProblem& bundle, uint32_t photo, const std::vector<uint32_t>& entries, const std::vector<uint32_t>& track_of,
                      double threshold) {
  BundlePhoto& moved = bundle.photos[photo];
  constexpr int kSteps = 10;
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::VectorXd change = PoseChange(bundle, moved, entries, track_of, threshold);
    if (!change.allFinite()) break;
    const Eigen::Vector3d turn = change.head<3>();
    if (turn.norm() > 0.0) {
      moved.cam_from_enu = (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * moved.cam_from_enu).normalized();
    }
    moved.centre += change.tail<3>();
  }
  size_t n = 0;
  for (const uint32_t e : entries) {
    const uint32_t t = track_of[e];
    const double error = bundle.has_point[t] != 0 ? bundle.Error(e, bundle.point[t]) : -1.0;
    bundle.agrees[e] = error >= 0.0 && error <= threshold ? 1 : 0;
    n += bundle.agrees[e] != 0 ? 1 : 0;
  }
  return n;
}

}  // namespace skyquilt::prepare::bundle
