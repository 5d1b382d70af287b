#include "prepare/georeference/gravity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/log.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/bundle/robust.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Basis = Eigen::Matrix<double, 3, 2>;

constexpr double kRadiansPerDegree = std::numbers::pi / 180.0;
constexpr int kGravityRounds = 15;
// Poses of a reconstruction bend and drift by about this much, which no number of photos averages out.
constexpr double kPoseFloor_deg = 0.05;
constexpr double kGimbalNoise_deg = 0.2;  // at least
constexpr double kCameraNoise_deg = 1.0;  // at least
constexpr double kNadir_deg = 20.0;       // cameras within this of straight down are meant to look straight down
constexpr int kMinPoints = 30;
// Heights of neighbouring points are not independent: a plane has no more information than this many.
constexpr double kIndependentPoints = 30.0;
constexpr double kShownShare = 0.01;  // evidence with a smaller share cannot contradict the rest

// Two unit vectors perpendicular to `up` and to each other.
Basis TangentBasis(const Vector3d& up) {
  Basis basis;
  basis.col(0) = up.unitOrthogonal();
  basis.col(1) = up.cross(basis.col(0));
  return basis;
}

double SigmaOf(const Vector3d& up, const Matrix3d& information) {
  const Basis basis = TangentBasis(up);
  const Eigen::Matrix2d tangent = basis.transpose() * information * basis;
  if (!(linear::Determinant(tangent) > 1e-12 * tangent.squaredNorm()) || !(tangent(0, 0) > 0.0)) return std::numeric_limits<double>::infinity();
  return std::sqrt(linear::Inverse(tangent).trace());
}

// Information from a covariance in the tangent plane.
Matrix3d Information(const Basis& basis, const Eigen::Matrix2d& covariance) {
  return basis * linear::Inverse(covariance) * basis.transpose();
}

// One camera's statement: up in its frame, of which only the components along some directions count.
struct Statement {
  Matrix3d cam_from_model;
  Vector3d up_in_cam;  // as stated
  Basis directions;    // unit vectors in the camera's frame, perpendicular to up
  int n_directions = 2;
};

Statement MakeStatement(const Matrix3d& cam_from_model, const Vector3d& up_in_cam) {
  Statement statement{.cam_from_model = cam_from_model, .up_in_cam = up_in_cam, .directions = Basis::Zero()};
  const Vector3d right = Vector3d::UnitX() - up_in_cam.x() * up_in_cam;
  statement.directions.col(0) = right.norm() > 1e-3 ? Vector3d(right.normalized()) : Vector3d::UnitY();
  statement.directions.col(1) = up_in_cam.cross(statement.directions.col(0));
  return statement;
}

struct AngleNoise {
  double common_deg;  // prior of an error of rotation that all cameras share, per axis
  double least_deg;   // smallest random error of one camera
};

// Least squares over all statements with Tukey's weights, together with the common rotation of the cameras against their stated orientation.
UpEvidence SolveUp(const std::vector<Statement>& statements, const Vector3d& start, const AngleNoise& noise) {
  UpEvidence result{.n = static_cast<int>(statements.size()), .up = start};
  double sigma = noise.least_deg * kRadiansPerDegree;
  Vector3d common = Vector3d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
  for (int round = 0; round < kGravityRounds; ++round) {
    const Basis basis = TangentBasis(result.up);
    std::vector<Eigen::Vector3d> residuals;
    std::vector<double> sizes;
    residuals.reserve(statements.size());
    sizes.reserve(2 * statements.size());
    for (const Statement& statement : statements) {
      const Vector3d residual = statement.cam_from_model * result.up - statement.up_in_cam - common.cross(statement.up_in_cam);
      residuals.push_back(residual);
      for (int i = 0; i < statement.n_directions; ++i) sizes.push_back(std::abs(statement.directions.col(i).dot(residual)));
    }
    sigma = std::max(noise.least_deg * kRadiansPerDegree, base::kMadToSigma * base::Median(sizes));
    Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
    Eigen::Matrix<double, 5, 1> right = Eigen::Matrix<double, 5, 1>::Zero();
    bundle::SerialCorrelation correlation;
    for (size_t i = 0; i < statements.size(); ++i) {
      const Statement& statement = statements[i];
      Eigen::Matrix<double, 3, 5> jacobian;
      jacobian.leftCols<2>() = statement.cam_from_model * basis;
      const Vector3d& s = statement.up_in_cam;
      // d(common x s) = -[s]x d(common), and the residual subtracts it.
      jacobian.rightCols<3>() << 0.0, -s.z(), s.y(), s.z(), 0.0, -s.x(), -s.y(), s.x(), 0.0;
      for (int k = 0; k < statement.n_directions; ++k) {
        const Eigen::Matrix<double, 1, 5> row = statement.directions.col(k).transpose() * jacobian;
        const double residual = statement.directions.col(k).dot(residuals[i]);
        const double weight = bundle::TukeyWeight(residual / sigma);
        normal += weight * row.transpose() * row;
        right += weight * row.transpose() * residual;
        correlation.Add(static_cast<size_t>(k), std::sqrt(weight) * residual);
      }
    }
    // Errors of neighbouring photos are alike: wind, a turn, the drift of a gimbal.
    const double scale = 1.0 / (sigma * sigma * correlation.VarianceFactor());
    normal *= scale;
    right *= scale;
    const double prior = 1.0 / std::pow(noise.common_deg * kRadiansPerDegree, 2);
    normal.bottomRightCorner<3, 3>().diagonal().array() += prior;
    right.tail<3>() += prior * common;
    // Keeps directions without any evidence in place; their variance stays large.
    normal.topLeftCorner<2, 2>().diagonal().array() += 1e-3;
    const Eigen::Matrix<double, 5, 5> inverse = linear::Inverse<Eigen::Dynamic>(normal);
    const Eigen::Matrix<double, 5, 1> step = -(inverse * right);
    result.up = (result.up + basis * step.head<2>()).normalized();
    common += step.tail<3>();
    covariance = inverse.topLeftCorner<2, 2>();
    covariance.diagonal().array() += 0.5 * std::pow(kPoseFloor_deg * kRadiansPerDegree, 2);
    result.information = Information(basis, covariance);
    if (round > 3 && step.norm() < 1e-9) break;
  }
  return result;
}

}  // namespace

double UpEvidence::Sigma() const {
  return SigmaOf(up, information);
}

double Gravity::Sigma() const {
  return SigmaOf(up, information);
}

std::vector<UpEvidence> GimbalEvidence(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<Statement> statements;
  std::array<std::vector<double>, 3> component;
  for (const input::PreparedPhoto& photo : photos) {
    if (!photo.up_in_cam) continue;
    statements.push_back(MakeStatement(photo.cam_from_model.rotation.toRotationMatrix(), *photo.up_in_cam));
    const Vector3d up = photo.cam_from_model.rotation.conjugate() * *photo.up_in_cam;
    for (size_t axis = 0; axis < 3; ++axis) component[axis].push_back(up[static_cast<Eigen::Index>(axis)]);
  }
  if (statements.empty()) return {};
  const Vector3d middle(base::Median(component[0]), base::Median(component[1]), base::Median(component[2]));
  if (!(middle.norm() > 0.1)) return {};  // the angles contradict each other altogether
  UpEvidence evidence = SolveUp(statements, middle.normalized(), {kGimbalCommon_deg, kGimbalNoise_deg});
  evidence.kind = "gimbal";
  return {evidence};
}

std::vector<UpEvidence> CameraEvidence(const std::vector<input::PreparedPhoto>& photos, const UpByTagsFunction& tags_up) {
  if (photos.empty()) return {};
  const HeldCameras held = FindHeldCameras(photos, tags_up);
  UpEvidence evidence{.up = held.up};
  // Which cameras are meant to look straight down depends on the result.
  for (int round = 0; round < 3; ++round) {
    std::vector<Statement> statements;
    statements.reserve(photos.size());
    for (const Eigen::Quaterniond& rotation : held.cam_from_model) {
      const Matrix3d cam_from_model = rotation.toRotationMatrix();
      const Vector3d view = rotation.conjugate() * Vector3d::UnitZ();
      const bool nadir = -view.dot(evidence.up) > std::cos(kNadir_deg * kRadiansPerDegree);
      Vector3d up_in_cam = nadir ? Vector3d(0.0, 0.0, -1.0) : Vector3d(cam_from_model * evidence.up);
      up_in_cam.x() = 0.0;
      statements.push_back(MakeStatement(cam_from_model, up_in_cam.normalized()));
      statements.back().n_directions = nadir ? 2 : 1;
    }
    evidence = SolveUp(statements, evidence.up, {kCameraCommon_deg, kCameraNoise_deg});
  }
  evidence.kind = "cameras";
  return {evidence};
}

std::vector<UpEvidence> GroundEvidence(const std::vector<Vector3d>& points, const Vector3d& rough_up) {
  if (points.size() < kMinPoints) return {};
  std::array<std::vector<double>, 3> component;
  for (const Vector3d& x : points) {
    for (size_t axis = 0; axis < 3; ++axis) component[axis].push_back(x[static_cast<Eigen::Index>(axis)]);
  }
  Vector3d middle(base::Median(component[0]), base::Median(component[1]), base::Median(component[2]));
  std::vector<double> radius;
  radius.reserve(points.size());
  for (const Vector3d& x : points) radius.push_back((x - middle).norm());
  const double farthest = 3.0 * base::Median(radius);
  std::vector<double> weight;
  weight.reserve(points.size());
  for (const double r : radius) weight.push_back(r <= farthest ? 1.0 : 0.0);
  linear::EigenPairs<3> eigen;
  double roughness = 0.0;
  for (int round = 0; round < kGravityRounds; ++round) {
    Vector3d sum = Vector3d::Zero();
    double total = 0.0;
    for (size_t i = 0; i < points.size(); ++i) {
      sum += weight[i] * points[i];
      total += weight[i];
    }
    if (!(total > 0.0)) return {};
    middle = sum / total;
    Matrix3d covariance = Matrix3d::Zero();
    for (size_t i = 0; i < points.size(); ++i) covariance += weight[i] / total * (points[i] - middle) * (points[i] - middle).transpose();
    eigen = linear::SymmetricEigen(covariance);
    const Vector3d normal = eigen.vectors.col(0);
    std::vector<double> distance;
    distance.reserve(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      if (radius[i] <= farthest) distance.push_back(std::abs(normal.dot(points[i] - middle)));
    }
    roughness = base::kMadToSigma * base::Median(distance);
    if (!(roughness > 0.0)) break;
    for (size_t i = 0; i < points.size(); ++i)
      weight[i] = radius[i] <= farthest ? bundle::TukeyWeight(normal.dot(points[i] - middle) / roughness) : 0.0;
  }
  const Vector3d spread = eigen.values.cwiseMax(0.0).cwiseSqrt();
  if (!(spread[1] > 0.02 * spread[2]) || !(spread[0] < 0.7 * spread[1])) return {};  // a line, or no plane at all
  UpEvidence evidence{.kind = "ground", .n = static_cast<int>(points.size()), .up = eigen.vectors.col(0)};
  if (evidence.up.dot(rough_up) < 0.0) evidence.up = -evidence.up;
  for (int axis = 1; axis < 3; ++axis) {
    const double fit = roughness / (spread[axis] * std::sqrt(kIndependentPoints));
    const double variance = 0.5 * std::pow(kGroundSlope_deg * kRadiansPerDegree, 2) + fit * fit;
    evidence.information += eigen.vectors.col(axis) * eigen.vectors.col(axis).transpose() / variance;
  }
  return {evidence};
}

namespace {

// By the user.
std::vector<UpEvidence> StatedEvidence(const Vector3d& up) {
  const double variance = 0.5 * std::pow(kStatedUp_deg * kRadiansPerDegree, 2);
  const Vector3d direction = up.normalized();
  return {{.kind = "stated", .n = 1, .up = direction, .information = Information(TangentBasis(direction), variance * Eigen::Matrix2d::Identity())}};
}

// Variance of `up` along a direction, by the information of the evidence so far.
double VarianceAlong(const Vector3d& up, const Matrix3d& information, const Vector3d& direction) {
  const Basis basis = TangentBasis(up);
  const Eigen::Vector2d along = basis.transpose() * direction;
  return along.dot(linear::Inverse<2>(basis.transpose() * information * basis) * along);
}

// The ground where the plane of the points agrees with up by the cameras or the gimbal. Where it is about upright, and as plumb as these and it
// itself are accurate, it is a wall, which `trust_walls` lets count. Else nothing; the log says so.
std::vector<UpEvidence> PlaneEvidence(const std::vector<Vector3d>& points, const UpEvidence& by_photos, bool trust_walls) {
  std::vector<UpEvidence> plane = GroundEvidence(points, by_photos.up);
  if (plane.empty()) return {};
  const Vector3d normal = plane.front().up;
  const double leans_deg = std::atan2(normal.cross(by_photos.up).norm(), normal.dot(by_photos.up)) / kRadiansPerDegree;
  if (leans_deg <= kGroundAgrees_deg) return plane;
  constexpr double kSigmas = 3.0;
  const double sigma = plane.front().Sigma();
  const double off_plumb = (90.0 - leans_deg) * kRadiansPerDegree;
  const bool wall = trust_walls && leans_deg >= 90.0 - kGroundAgrees_deg &&
                    off_plumb <= kSigmas * std::sqrt(sigma * sigma + VarianceAlong(by_photos.up, by_photos.information, normal));
  base::LogInfo("the plane of the sparse points leans by {:.0f} degrees against up by the {}: it is taken for {}, not for the ground", leans_deg,
                by_photos.kind == "gimbal" ? "gimbal angles" : "cameras", wall ? "a wall" : "no evidence of gravity");
  if (!wall) return {};
  const Vector3d plumb = by_photos.up - normal.dot(by_photos.up) * normal;
  return {{.kind = "wall", .n = plane.front().n, .up = plumb.normalized(), .information = normal * normal.transpose() / (sigma * sigma)}};
}

}  // namespace

Gravity FindGravity(const std::vector<input::PreparedPhoto>& photos, const std::vector<Vector3d>& points, const GravityHints& hints) {
  Gravity gravity;
  std::vector<UpEvidence> gimbal = GimbalEvidence(photos);
  std::vector<UpEvidence> cameras = CameraEvidence(photos, hints.tags_up);
  if (cameras.empty()) return gravity;
  const bool enough = !gimbal.empty() && 2 * gimbal.front().n >= static_cast<int>(photos.size());
  const bool stated = hints.stated_up.has_value();
  for (UpEvidence& evidence : gimbal) evidence.used = !stated;
  for (UpEvidence& evidence : cameras) evidence.used = !enough && !stated;
  const Vector3d rough_up = stated ? hints.stated_up->normalized() : enough ? gimbal.front().up : cameras.front().up;
  if (stated) gravity.evidence = StatedEvidence(*hints.stated_up);
  gravity.evidence.insert(gravity.evidence.end(), gimbal.begin(), gimbal.end());
  gravity.evidence.insert(gravity.evidence.end(), cameras.begin(), cameras.end());
  if (!stated) {
    for (UpEvidence& evidence : PlaneEvidence(points, enough ? gimbal.front() : cameras.front(), !enough))
      gravity.evidence.push_back(std::move(evidence));
  }

  gravity.up = rough_up;
  for (int round = 0; round < kGravityRounds; ++round) {
    gravity.information.setZero();
    Vector3d pull = Vector3d::Zero();
    for (const UpEvidence& evidence : gravity.evidence) {
      if (!evidence.used) continue;
      gravity.information += evidence.information;
      pull += evidence.information * (evidence.up - gravity.up);
    }
    const Basis basis = TangentBasis(gravity.up);
    const Eigen::Matrix2d normal = basis.transpose() * gravity.information * basis;
    gravity.up = (gravity.up + basis * (linear::Inverse(normal) * (basis.transpose() * pull))).normalized();
  }
  double chi_squared = 0.0;
  int n_independent = -1;
  const double sigma = gravity.Sigma();
  for (const UpEvidence& evidence : gravity.evidence) {
    if (!evidence.used || !(sigma * sigma > kShownShare * evidence.Sigma() * evidence.Sigma())) continue;
    const Vector3d difference = evidence.up - gravity.up;
    chi_squared += difference.dot(evidence.information * difference);
    ++n_independent;
  }
  if (n_independent > 0) gravity.information /= std::max(1.0, chi_squared / (2.0 * n_independent));
  return gravity;
}

}  // namespace skyquilt::prepare::georeference
