#include "prepare/georeference/place_adjustment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "prepare/bundle/robust.h"

namespace skyquilt::prepare::georeference {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kAdjustmentRounds = 30;
constexpr Index kGlobal = 8;  // rotation 3, log scale, position 3, lag
// Tukey's weights make the weighted sum of squares of normal noise smaller by this factor.
constexpr double kTukeySquares = 0.828;
constexpr double kLeastNoise_m = 0.01;

Matrix3d Cross(const Vector3d& v) {
  Matrix3d m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

// Standard deviation per axis of one component of the tags: robust for the weights, by the weighted squares for the covariance.
struct TagNoise {
  double robust = 1.0;    // over the stated accuracy
  double variance = 1.0;  // correction by the weighted squares, widened for serial correlation
};

class Solver {
 public:
  Solver(const AdjustmentInput& input, const AdjustmentStart& start)
      : input_(input),
        rotation_(start.enu_from_model.rotation),
        log_scale_(std::log(start.enu_from_model.scale)),
        position_(start.enu_from_model * input.middle_in_model),
        lag_s_(start.lag_s),
        bias_(start.bias) {
    for (Index k = 0; k < static_cast<Index>(input.tags.size()); ++k) {
      Span span;
      for (Index j = 0; j < input.bias.size(); ++j) {
        if (input.bias.basis()(k, j) == 0.0) continue;
        if (span.count == 0) span.first = j;
        span.count = j - span.first + 1;
      }
      spans_.push_back(span);
    }
  }

  Adjustment Run() {
    for (int round = 0; round < kAdjustmentRounds; ++round) {
      Evaluate();
      const Eigen::VectorXd step = Step();
      if (round > 5 && step.head(4).norm() < 1e-10 && step.segment(4, 3).norm() < 1e-6) break;
    }
    Evaluate();
    return Result();
  }

 private:
  double Scale() const { return std::exp(log_scale_); }

  // Residuals, weights and noise at the present state.
  void Evaluate() {
    const size_t n = input_.tags.size();
    arm_.resize(n);
    velocity_.resize(n);
    residual_.resize(n);
    weight_h_.assign(n, 0.0);
    weight_v_.assign(n, 0.0);
    const Matrix3d turn = Scale() * rotation_.toRotationMatrix();
    const Eigen::VectorXd bias = bias_.size() > 0 ? Eigen::VectorXd(input_.bias.basis() * bias_) : Eigen::VectorXd::Zero(static_cast<Index>(n));
    std::vector<double> horizontal, vertical;
    for (size_t k = 0; k < n; ++k) {
      const Tag& tag = input_.tags[k];
      const TrackPoint point = input_.track.Before(tag.photo, lag_s_);
      arm_[k] = turn * (point.position - input_.middle_in_model);
      velocity_[k] = turn * point.velocity;
      residual_[k] = arm_[k] + position_ - tag.x_in_enu;
      residual_[k].z() += bias[static_cast<Index>(k)];
      if (!(residual_[k].head<2>().norm() <= input_.threshold_m)) continue;
      horizontal.push_back(residual_[k].head<2>().norm() / tag.horizontal_sigma_m);
      if (std::abs(residual_[k].z()) <= input_.threshold_m) vertical.push_back(std::abs(residual_[k].z()) / tag.vertical_sigma_m);
    }
    noise_h_.robust = horizontal.empty() ? 1.0 : base::Median(horizontal) / bundle::kRayleighMedian;
    noise_v_.robust = vertical.empty() ? 1.0 : base::Median(vertical) * base::kMadToSigma;
    bundle::SerialCorrelation correlation_h, correlation_v;
    double squares_h = 0.0, squares_v = 0.0, sum_h = 0.0, sum_v = 0.0;
    for (size_t k = 0; k < n; ++k) {
      const Tag& tag = input_.tags[k];
      const double r = residual_[k].head<2>().norm();
      if (!(r <= input_.threshold_m)) continue;
      weight_h_[k] = bundle::TukeyWeight(r / SigmaH(tag));
      squares_h += weight_h_[k] * std::pow(r / SigmaH(tag), 2);
      sum_h += weight_h_[k];
      const double root = std::sqrt(weight_h_[k]) / SigmaH(tag);
      correlation_h.Add(0, root * residual_[k].x());
      correlation_h.Add(1, root * residual_[k].y());
      const double up = std::abs(residual_[k].z());
      if (!(up <= input_.threshold_m)) continue;
      weight_v_[k] = bundle::TukeyWeight(up / SigmaV(tag));
      squares_v += weight_v_[k] * std::pow(up / SigmaV(tag), 2);
      sum_v += weight_v_[k];
      correlation_v.Add(0, std::sqrt(weight_v_[k]) / SigmaV(tag) * residual_[k].z());
    }
    // Degrees of freedom: scale, yaw, position and lag share two numbers per tag; height and tilt one.
    noise_h_.variance = VarianceOf(squares_h, 2.0 * sum_h - (input_.lag_sigma_s > 0.0 ? 5.0 : 4.0)) * correlation_h.VarianceFactor();
    noise_v_.variance = VarianceOf(squares_v, sum_v - 2.0) * correlation_v.VarianceFactor();
  }

  // Effective standard deviations per axis. However well tags agree, a reconstruction is not better than kLeastNoise_m.
  double SigmaH(const Tag& tag) const { return std::max(tag.horizontal_sigma_m * noise_h_.robust, kLeastNoise_m); }
  double SigmaV(const Tag& tag) const { return std::max(tag.vertical_sigma_m * noise_v_.robust, kLeastNoise_m); }

  // Variance of the tags over the square of their effective standard deviation.
  static double VarianceOf(double squares, double freedom) {
    constexpr double kLeast = 0.5;
    return freedom < 1.0 ? 1.0 : std::max(squares / (freedom * kTukeySquares), kLeast);
  }

  // The normal equations; with and without gravity.
  void Build() {
    const Index size = kGlobal + bias_.size();
    normal_ = Eigen::MatrixXd::Zero(size, size);
    gradient_ = Eigen::VectorXd::Zero(size);
    for (size_t k = 0; k < input_.tags.size(); ++k) {
      if (weight_h_[k] == 0.0) continue;
      const Tag& tag = input_.tags[k];
      Eigen::Matrix<double, 3, kGlobal> row;
      row.leftCols<3>() = -Cross(arm_[k]);
      row.col(3) = arm_[k];
      row.middleCols<3>(4).setIdentity();
      row.col(7) = -velocity_[k];
      const double h = weight_h_[k] / (SigmaH(tag) * SigmaH(tag) * noise_h_.variance);
      const double v = weight_v_[k] / (SigmaV(tag) * SigmaV(tag) * noise_v_.variance);
      for (Index axis = 0; axis < 3; ++axis) {
        const double weight = axis < 2 ? h : v;
        if (weight == 0.0) continue;
        normal_.topLeftCorner<kGlobal, kGlobal>() += weight * row.row(axis).transpose() * row.row(axis);
        gradient_.head<kGlobal>() += weight * row.row(axis).transpose() * residual_[k][axis];
      }
      const Span& span = spans_[k];
      if (v == 0.0 || span.count == 0) continue;
      // Only the parameters of the tag's own flight: with many flights the rest of the row is zero.
      const Eigen::RowVectorXd basis = input_.bias.basis().row(static_cast<Index>(k)).segment(span.first, span.count);
      const Index at = kGlobal + span.first;
      normal_.block(0, at, kGlobal, span.count) += v * row.row(2).transpose().lazyProduct(basis);
      normal_.block(at, at, span.count, span.count) += v * basis.transpose().lazyProduct(basis);
      gradient_.segment(at, span.count) += v * basis.transpose() * residual_[k].z();
    }
    normal_.bottomLeftCorner(bias_.size(), kGlobal) = normal_.topRightCorner(kGlobal, bias_.size()).transpose();
    if (bias_.size() > 0) {
      const Eigen::VectorXd prior = input_.bias.Sigmas(input_.bias_sigmas).array().square().inverse();
      normal_.diagonal().tail(bias_.size()) += prior;
      gradient_.tail(bias_.size()) += prior.cwiseProduct(bias_);
    }
    constexpr double kFixed_s = 1e-6;
    const double lag_prior = std::pow(input_.lag_sigma_s > 0.0 ? input_.lag_sigma_s : kFixed_s, -2);
    normal_(7, 7) += lag_prior;
    gradient_[7] += lag_prior * lag_s_;
    // Without any height, position and tilt stay where gravity and the start put them.
    constexpr double kAnyHeight_m = 1e4;
    normal_(6, 6) += 1.0 / (kAnyHeight_m * kAnyHeight_m);
    tags_normal_ = normal_;
    const Matrix3d rotation = rotation_.toRotationMatrix();
    const Vector3d up = rotation * input_.gravity.up;
    const Matrix3d information = rotation * input_.gravity.information * rotation.transpose();
    const Matrix3d jacobian = -Cross(up);
    gravity_normal_ = jacobian.transpose() * information * jacobian;
    gravity_gradient_ = jacobian.transpose() * information * (up - Vector3d::UnitZ());
    normal_.topLeftCorner<3, 3>() += gravity_normal_;
    gradient_.head<3>() += gravity_gradient_;
  }

  Eigen::VectorXd Step() {
    Build();
    Eigen::VectorXd step = -linear::SolveSymmetric(normal_, gradient_);
    if (!step.allFinite()) return Eigen::VectorXd::Zero(normal_.rows());
    const Vector3d turn = step.head<3>();
    if (turn.norm() > 0.0) rotation_ = (Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * rotation_).normalized();
    log_scale_ += step[3];
    position_ += step.segment<3>(4);
    lag_s_ += step[7];
    bias_ += step.tail(bias_.size());
    return step;
  }

  Adjustment Result() {
    Build();
    Adjustment result;
    result.enu_from_model.scale = Scale();
    result.enu_from_model.rotation = rotation_;
    result.enu_from_model.translation = position_ - Scale() * (rotation_ * input_.middle_in_model);
    result.lag_s = input_.lag_sigma_s > 0.0 ? lag_s_ : 0.0;
    const size_t n = input_.tags.size();
    result.bias_m.assign(n, 0.0);
    result.inlier.assign(n, 0);
    const Eigen::VectorXd bias = bias_.size() > 0 ? Eigen::VectorXd(input_.bias.basis() * bias_) : Eigen::VectorXd::Zero(static_cast<Index>(n));
    for (size_t k = 0; k < n; ++k) {
      result.bias_m[k] = bias[static_cast<Index>(k)];
      const double up = residual_[k].z();
      result.inlier[k] = residual_[k].head<2>().norm() <= input_.threshold_m && (std::isnan(up) || std::abs(up) <= input_.threshold_m) ? 1 : 0;
    }
    result.horizontal_noise = noise_h_.robust;
    result.vertical_noise = noise_v_.robust;
    const Index size = normal_.rows();
    const Eigen::MatrixXd inverse = linear::SolveSymmetric(normal_, Eigen::MatrixXd::Identity(size, size));
    result.covariance = inverse.topLeftCorner<kGlobal, kGlobal>();
    // The tags' own statement on the rotation about east and north: everything else eliminated.
    const Index rest = size - 2;
    const Eigen::MatrixXd others = tags_normal_.bottomRightCorner(rest, rest);
    const Eigen::MatrixXd coupling = tags_normal_.topRightCorner(2, rest);
    result.tags_information = tags_normal_.topLeftCorner<2, 2>() - coupling.lazyProduct(linear::SolveSymmetric(others, coupling.transpose()));
    const Eigen::Vector2d values = linear::SymmetricEigen(result.tags_information).values;
    if (values[0] > 1e-9 * std::max(1.0, values[1])) {
      result.tags_covariance = linear::Inverse(result.tags_information);
      // At the optimum gravity and tags pull with the same force against each other.
      result.tags_rotation = result.tags_covariance * gravity_gradient_.head<2>();
    }
    return result;
  }

  // Bias parameters that a tag depends on.
  struct Span {
    Index first = 0, count = 0;
  };

  const AdjustmentInput& input_;
  std::vector<Span> spans_;  // per tag
  Eigen::Quaterniond rotation_;
  double log_scale_;
  Vector3d position_;
  double lag_s_;
  Eigen::VectorXd bias_;
  std::vector<Vector3d> arm_, velocity_, residual_;
  std::vector<double> weight_h_, weight_v_;
  TagNoise noise_h_, noise_v_;
  Eigen::MatrixXd normal_, tags_normal_;
  Eigen::VectorXd gradient_;
  Matrix3d gravity_normal_ = Matrix3d::Zero();
  Vector3d gravity_gradient_ = Vector3d::Zero();
};

}  // namespace

Adjustment Adjust(const AdjustmentInput& input, const AdjustmentStart& start) {
  SKYQUILT_CHECK(start.bias.size() == input.bias.size(), std::to_string(start.bias.size()) + " bias parameters");
  return Solver(input, start).Run();
}

}  // namespace skyquilt::prepare::georeference
