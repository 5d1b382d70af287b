#include "prepare/bundle/intrinsics_sigma.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/linear/linear.h"
#include "prepare/bundle/camera_sample.h"

namespace skyquilt::prepare::bundle {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Matrix23d = Eigen::Matrix<double, 2, 3>;
using Matrix26d = Eigen::Matrix<double, 2, 6>;
using Matrix2Xd = Eigen::Matrix<double, 2, Eigen::Dynamic>;

// Residuals below this are rounding, not measurement: no feature is located to a thousandth of a pixel.
constexpr double kExactResidual_px = 1e-3;
// Below this share of the largest eigenvalue of the information on the camera, differences of rounded numbers remain.
constexpr double kInformationFloor = 1e-12;
constexpr int kFrameFreedoms = 7;

bool HasDistortion(const camera::Camera& camera, int k1_index) {
  return std::any_of(camera.params.begin() + k1_index, camera.params.end(), [](double value) { return value != 0.0; });
}

// Indices of the parameters that the adjustment changed.
std::vector<size_t> FreeParameters(const camera::Camera& camera) {
  const Eigen::Vector2d middle = 0.5 * Eigen::Vector2d(camera.width, camera.height);
  const bool held = camera.PrincipalPoint() == middle;
  const size_t principal = camera::HasOneFocalLength(camera.model) ? 1 : 2;
  std::vector<size_t> free;
  for (size_t i = 0; i < camera.params.size(); ++i) {
    if (!held || (i != principal && i != principal + 1)) free.push_back(i);
  }
  return free;
}

struct Linearized {
  Eigen::Vector2d residual;  // measured less projected, pixels
  Matrix26d pose;            // derivatives of the projection: rotation vector (applied after the pose's rotation), translation
  Matrix23d point;           // in world coordinates
  Matrix2Xd camera;          // free parameters
};

// Takes derivatives of the project's own camera models by central differences.
class Linearizer {
 public:
  Linearizer(const camera::Camera& camera, std::vector<size_t> free) : camera_(camera), free_(std::move(free)) {}

  // Nothing for a point that the camera cannot see, where the distortion has no meaning.
  std::optional<Linearized> At(const geo::Rigid3d& cam_from_world, const Eigen::Vector3d& x_in_world, const Eigen::Vector2d& pixel) {
    const Eigen::Vector3d rotated = cam_from_world.rotation * x_in_world;
    const Eigen::Vector3d x_in_cam = rotated + cam_from_world.translation;
    const auto projected = camera_.ImgFromCam(x_in_cam);
    if (!projected) return std::nullopt;
    Linearized result;
    result.residual = pixel - *projected;
    Matrix23d by_cam;
    // 1e-6 of the depth moves the pixel by about a thousandth: far above rounding, far below where the lens' curvature counts.
    const double step = 1e-6 * x_in_cam.z();
    for (int axis = 0; axis < 3; ++axis) {
      const auto slope = Difference([&](double shift) { return camera_.ImgFromCam(x_in_cam + shift * Eigen::Vector3d::Unit(axis)); }, step);
      if (!slope) return std::nullopt;
      by_cam.col(axis) = *slope;
    }
    result.camera.resize(2, static_cast<Index>(free_.size()));
    for (size_t i = 0; i < free_.size(); ++i) {
      const auto slope = ByParameter(free_[i], x_in_cam);
      if (!slope) return std::nullopt;
      result.camera.col(static_cast<Index>(i)) = *slope;
    }
    Eigen::Matrix3d cross;
    cross << 0.0, rotated.z(), -rotated.y(), -rotated.z(), 0.0, rotated.x(), rotated.y(), -rotated.x(), 0.0;
    result.pose.leftCols<3>() = by_cam * cross;
    result.pose.rightCols<3>() = by_cam;
    result.point = by_cam * cam_from_world.rotation.toRotationMatrix();
    return result;
  }

 private:
  template <typename Projection>
  static std::optional<Eigen::Vector2d> Difference(const Projection& at, double step) {
    const auto ahead = at(step);
    const auto behind = at(-step);
    if (!ahead || !behind) return std::nullopt;
    return (*ahead - *behind) / (2.0 * step);
  }

  std::optional<Eigen::Vector2d> ByParameter(size_t index, const Eigen::Vector3d& x_in_cam) {
    double& parameter = camera_.params[index];
    const double value = parameter;
    // Focal lengths and principal point are in pixels, distortion near 1.
    const double step = 1e-6 * std::max(1.0, std::abs(value));
    auto slope = Difference(
        [&](double shift) {
          parameter = value + shift;
          return camera_.ImgFromCam(x_in_cam);
        },
        step);
    parameter = value;
    return slope;
  }

  camera::Camera camera_;
  std::vector<size_t> free_;
};

// Normal equations without the points: poses, then the camera's free parameters.
struct Reduced {
  MatrixXd poses;        // 6 n x 6 n, lower triangle
  MatrixXd pose_camera;  // 6 n x m
  MatrixXd camera;       // m x m
  double sum_of_squares = 0.0;
  int n_observations = 0;
  int n_points = 0;
};

// Adds one point's observations and eliminates the point (Schur complement).
void AddPoint(const std::vector<std::pair<int, Linearized>>& rows, Reduced& reduced) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const auto& [photo, row] : rows) information += row.point.transpose() * row.point;
  MatrixXd columns(3, 2 * static_cast<Index>(rows.size())), roots;
  for (size_t i = 0; i < rows.size(); ++i) columns.middleCols<2>(2 * static_cast<Index>(i)) = rows[i].second.point.transpose();
  if (!linear::SolveLowerCholesky(information, columns, &roots, 1e-14)) return;
  // B L^-T turns B^T A, which the point takes away, into a sum of squares.
  std::vector<Eigen::Matrix<double, 6, 3>> taken;
  taken.reserve(rows.size());
  MatrixXd camera_taken = MatrixXd::Zero(reduced.camera.rows(), 3);
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto& row = rows[i].second;
    const Eigen::Matrix<double, 3, 2> root = roots.middleCols<2>(2 * static_cast<Index>(i));
    taken.emplace_back(row.pose.transpose() * root.transpose());
    camera_taken += row.camera.transpose().lazyProduct(root.transpose());
  }
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto& [photo, row] = rows[i];
    const Index at = 6 * static_cast<Index>(photo);
    reduced.poses.block<6, 6>(at, at).noalias() += row.pose.transpose() * row.pose;
    reduced.pose_camera.middleRows<6>(at).noalias() += row.pose.transpose().lazyProduct(row.camera) - taken[i].lazyProduct(camera_taken.transpose());
    reduced.camera += row.camera.transpose().lazyProduct(row.camera);
    reduced.sum_of_squares += row.residual.squaredNorm();
    for (size_t j = 0; j < rows.size(); ++j) {
      if (rows[j].first > photo) continue;
      reduced.poses.block<6, 6>(at, 6 * static_cast<Index>(rows[j].first)).noalias() -= taken[i] * taken[j].transpose();
    }
  }
  reduced.camera -= camera_taken.lazyProduct(camera_taken.transpose());
  reduced.n_observations += static_cast<int>(rows.size());
  ++reduced.n_points;
}

Reduced BuildNormalEquations(const CameraSample& sample, const camera::Camera& camera, const std::vector<size_t>& free) {
  const Index n = 6 * static_cast<Index>(sample.cam_from_world.size());
  const auto m = static_cast<Index>(free.size());
  Reduced reduced{MatrixXd::Zero(n, n), MatrixXd::Zero(n, m), MatrixXd::Zero(m, m)};
  Linearizer linearizer(camera, free);
  std::vector<std::pair<int, Linearized>> rows;
  for (const SamplePoint& point : sample.points) {
    rows.clear();
    for (const Sighting& sighting : point.sightings) {
      auto row = linearizer.At(sample.cam_from_world[static_cast<size_t>(sighting.photo)], point.x_in_world, sighting.pixel);
      if (row) rows.emplace_back(sighting.photo, std::move(*row));
    }
    if (rows.size() >= 2) AddPoint(rows, reduced);
  }
  return reduced;
}

// The pose unknowns that are estimated. The frame is held by the first pose, and its scale by one coordinate of the farthest other camera, the one
// that changes most with the scale. The camera's own parameters do not depend on this choice.
std::vector<Index> EstimatedPoseUnknowns(const std::vector<geo::Rigid3d>& poses) {
  const Eigen::Vector3d first = poses.front().OriginInSource();
  size_t farthest = 1;
  const auto baseline = [&](size_t i) -> Eigen::Vector3d { return poses[i].OriginInSource() - first; };
  for (size_t i = 2; i < poses.size(); ++i) {
    if (baseline(i).squaredNorm() > baseline(farthest).squaredNorm()) farthest = i;
  }
  Index axis = 0;
  (poses[farthest].rotation * baseline(farthest)).cwiseAbs().maxCoeff(&axis);
  const Index held = 6 * static_cast<Index>(farthest) + 3 + axis;
  std::vector<Index> estimated;
  for (Index i = 6; i < 6 * static_cast<Index>(poses.size()); ++i) {
    if (i != held) estimated.push_back(i);
  }
  return estimated;
}

// What the observations say about the camera's free parameters when poses and points are unknown too: m x m, without the factor 1 / sigma0^2.
std::optional<MatrixXd> CameraInformation(const Reduced& reduced, const std::vector<Index>& estimated) {
  MatrixXd poses = reduced.poses(estimated, estimated);
  MatrixXd pose_camera = reduced.pose_camera(estimated, Eigen::all);
  // Rotations and translations differ in size by orders of magnitude.
  const VectorXd scale = poses.diagonal().cwiseSqrt();
  if (!scale.allFinite() || !(scale.minCoeff() > 0.0)) return std::nullopt;
  const VectorXd inverse = scale.cwiseInverse();
  poses = inverse.asDiagonal() * poses * inverse.asDiagonal();
  pose_camera = inverse.asDiagonal() * pose_camera;
  MatrixXd taken;
  if (!linear::SolveLowerCholesky(poses, pose_camera, &taken)) return std::nullopt;
  return MatrixXd(reduced.camera - linear::TransposedProduct(taken, taken));
}

// Diagonal element of the inverse. Directions without information get a very large variance instead of infinity.
double InverseDiagonal(const MatrixXd& information, Index index) {
  const VectorXd scale = information.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (!scale.allFinite() || !(scale.minCoeff() > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const MatrixXd scaled = scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
  const linear::EigenPairs<Eigen::Dynamic> eigen = linear::SymmetricEigen(scaled);
  if (!eigen.found) return std::numeric_limits<double>::quiet_NaN();
  const double floor = kInformationFloor * eigen.values.maxCoeff();
  const VectorXd along = eigen.vectors.row(index);
  return along.cwiseAbs2().dot(eigen.values.cwiseMax(floor).cwiseInverse()) / (scale[index] * scale[index]);
}

}  // namespace

int RadialParameterIndex(camera::CameraModel model) {
  switch (model) {
    case camera::CameraModel::kSimpleRadial:
    case camera::CameraModel::kRadial:
    case camera::CameraModel::kSimpleRadialFisheye:
    case camera::CameraModel::kRadialFisheye:
      return 3;
    case camera::CameraModel::kOpencv:
    case camera::CameraModel::kOpencvFisheye:
    case camera::CameraModel::kFullOpencv:
    case camera::CameraModel::kThinPrismFisheye:
    case camera::CameraModel::kRadTanThinPrismFisheye:
      return 4;
    case camera::CameraModel::kSimplePinhole:
    case camera::CameraModel::kPinhole:
    case camera::CameraModel::kFov:
      break;
  }
  return -1;
}

LensAccuracy MeasureLensAccuracy(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id) {
  LensAccuracy accuracy;
  const auto found = model.cameras.find(camera_id);
  if (found == model.cameras.end()) return accuracy;
  const camera::Camera& camera = found->second;
  const int k1_index = RadialParameterIndex(camera.model);
  if (k1_index < 0 || !HasDistortion(camera, k1_index)) return accuracy;
  const CameraSample sample = SelectSample(model, observations, camera_id, kMaxLensPhotos, kMaxLensPoints);
  if (sample.cam_from_world.size() < 3) return accuracy;

  const std::vector<size_t> free = FreeParameters(camera);
  const Reduced reduced = BuildNormalEquations(sample, camera, free);
  accuracy.n_photos = static_cast<int>(sample.cam_from_world.size());
  accuracy.n_points = reduced.n_points;
  accuracy.n_observations = reduced.n_observations;
  const int redundancy = 2 * reduced.n_observations - 6 * accuracy.n_photos - 3 * reduced.n_points - static_cast<int>(free.size()) + kFrameFreedoms;
  if (redundancy < 1) return accuracy;
  accuracy.sigma0_px = std::sqrt(reduced.sum_of_squares / redundancy);
  if (!(accuracy.sigma0_px > kExactResidual_px)) return accuracy;
  const auto information = CameraInformation(reduced, EstimatedPoseUnknowns(sample.cam_from_world));
  if (!information) return accuracy;
  const auto sigma_of = [&](Index at) {
    const double sigma = accuracy.sigma0_px * std::sqrt(InverseDiagonal(*information, at) * sample.share_of_points);
    return std::isfinite(sigma) ? sigma : std::numeric_limits<double>::quiet_NaN();
  };
  accuracy.k1_sigma = sigma_of(std::find(free.begin(), free.end(), static_cast<size_t>(k1_index)) - free.begin());
  accuracy.focal_sigma = sigma_of(0) / camera.FocalX();
  return accuracy;
}

}  // namespace skyquilt::prepare::bundle
