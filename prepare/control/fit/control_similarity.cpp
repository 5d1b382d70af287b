#include "prepare/control/fit/control_similarity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/order_statistics.h"
#include "core/base/random.h"
#include "core/linear/linear.h"
#include "prepare/bundle/adjustment_accuracy.h"

namespace skyquilt::prepare::control {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector7 = Eigen::Vector<double, 7>;

// Of the longest side of the pairs' hull.
constexpr double kLeastWidth = 0.03;
constexpr double kBend = 0.002, kMaxBend_m = 3.0;

bool HasHeight(const ControlPair& pair) {
  return std::isfinite(pair.sigma_m.z());
}

// The noise of marks moves a point by about a pixel, and by more along the lines of sight.
Vector3d SigmaWithMarks(const ControlPair& pair, double scale) {
  const double gsd_m = scale * pair.gsd;
  return {std::hypot(pair.sigma_m.x(), gsd_m), std::hypot(pair.sigma_m.y(), gsd_m), std::hypot(pair.sigma_m.z(), 2.0 * gsd_m)};
}

// About the diagonal of the area; a wrong point does not enlarge it.
double ExtentOf(const std::vector<ControlPair>& pairs) {
  Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const ControlPair& pair : pairs) values.push_back(pair.in_enu[axis]);
    middle[axis] = base::Median(std::move(values));
  }
  std::vector<double> distances;
  for (const ControlPair& pair : pairs) distances.push_back((pair.in_enu - middle).head<2>().norm());
  return 4.0 * base::Median(std::move(distances));
}

// Error of a pair over what may be; 1 is the limit.
double RelativeError(const ControlPair& pair, const geo::Similarity3d& enu_from_model, double bend_m) {
  constexpr double kSigmas = 4.0;
  const Vector3d error = enu_from_model * pair.in_model - pair.in_enu;
  const Vector3d limit = kSigmas * SigmaWithMarks(pair, enu_from_model.scale) + Vector3d::Constant(bend_m);
  const double horizontal = error.head<2>().norm() / limit.x();
  return HasHeight(pair) ? std::max(horizontal, std::abs(error.z()) / limit.z()) : horizontal;
}

bool OnOneLineOf(const std::vector<Vector3d>& points) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& x : points) mean += x / static_cast<double>(points.size());
  Matrix3d squares = Matrix3d::Zero();
  for (const Vector3d& x : points) squares += (x - mean) * (x - mean).transpose();
  const Vector3d values = linear::SymmetricEigen(squares).values;
  return !(values[1] > kLeastWidth * kLeastWidth * values[2]);
}

using Triple = std::array<size_t, 3>;

std::vector<Triple> TriplesOf(const std::vector<size_t>& of) {
  constexpr size_t kMaxTriples = 10000;
  const size_t n = of.size();
  std::vector<Triple> triples;
  if (n * (n - 1) * (n - 2) / 6 <= kMaxTriples) {
    for (size_t i = 0; i < n; ++i) {
      for (size_t j = i + 1; j < n; ++j) {
        for (size_t k = j + 1; k < n; ++k) triples.push_back({of[i], of[j], of[k]});
      }
    }
    return triples;
  }
  base::Random random(1);
  while (triples.size() < kMaxTriples) {
    const Triple triple = {of[random.Below(static_cast<uint32_t>(n))], of[random.Below(static_cast<uint32_t>(n))],
                           of[random.Below(static_cast<uint32_t>(n))]};
    if (triple[0] != triple[1] && triple[0] != triple[2] && triple[1] != triple[2]) triples.push_back(triple);
  }
  return triples;
}

bool ByThree(const std::vector<ControlPair>& pairs, const Triple& triple, geo::Similarity3d* enu_from_model) {
  Matrix3d in_model, in_enu;
  for (int k = 0; k < 3; ++k) {
    in_model.col(k) = pairs[triple[static_cast<size_t>(k)]].in_model;
    in_enu.col(k) = pairs[triple[static_cast<size_t>(k)]].in_enu;
  }
  if (OnOneLineOf({in_enu.col(0), in_enu.col(1), in_enu.col(2)}) || OnOneLineOf({in_model.col(0), in_model.col(1), in_model.col(2)})) return false;
  const Eigen::Matrix4d matrix = linear::Similarity(in_model, in_enu);
  const double scale = matrix.topLeftCorner<3, 3>().col(0).norm();
  if (!matrix.allFinite() || !(scale > 0.0)) return false;
  *enu_from_model = {scale, Eigen::Quaterniond(Matrix3d(matrix.topLeftCorner<3, 3>() / scale)).normalized(), matrix.topRightCorner<3, 1>()};
  return true;
}

// Least squares over the pairs that agree, from a start. Sets transform, middle and covariance.
void RefineSimilarity(const std::vector<ControlPair>& pairs, ControlSimilarity* fit) {
  geo::Similarity3d& transform = fit->enu_from_model;
  constexpr int kSteps = 8;
  for (int step = 0; step <= kSteps; ++step) {
    fit->middle.setZero();
    double n = 0.0;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (fit->agrees[i] == 0) continue;
      fit->middle += transform * pairs[i].in_model;
      n += 1.0;
    }
    fit->middle /= n;
    Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Zero();
    Vector7 gradient = Vector7::Zero();
    double squares = 0.0, residuals = -7.0;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (fit->agrees[i] == 0) continue;
      const Vector3d x = transform * pairs[i].in_model, error = x - pairs[i].in_enu;
      const Eigen::Matrix<double, 3, 7> jacobian = bundle::SimilarityJacobian(x - fit->middle);
      const Vector3d weight = SigmaWithMarks(pairs[i], transform.scale).cwiseAbs2().cwiseInverse();
      normal += jacobian.transpose() * weight.asDiagonal() * jacobian;
      gradient += jacobian.transpose() * weight.asDiagonal() * error;
      squares += error.cwiseAbs2().dot(weight);
      residuals += HasHeight(pairs[i]) ? 3.0 : 2.0;
    }
    if (step == kSteps) {
      fit->covariance = linear::Inverse(normal) * (residuals > 0.0 ? std::max(1.0, squares / residuals) : 1.0);
      break;
    }
    const Vector7 change = -linear::SolveSymmetric(normal, gradient);
    if (!change.allFinite()) break;
    const double angle = change.segment<3>(3).norm(), factor = std::exp(change[6]);
    const Eigen::Quaterniond turn(angle > 0.0 ? Eigen::AngleAxisd(angle, change.segment<3>(3) / angle) : Eigen::AngleAxisd::Identity());
    transform.scale *= factor;
    transform.rotation = (turn * transform.rotation).normalized();
    transform.translation = fit->middle + factor * (turn * (transform.translation - fit->middle)) + change.head<3>();
  }
}

// The best of all triples by the number of pairs within the limits, or by the error that most pairs keep below.
class TripleSearch {
 public:
  TripleSearch(const std::vector<ControlPair>& pairs, double bend_m) : pairs_(pairs), bend_m_(bend_m) {}

  void Try(const geo::Similarity3d& candidate) {
    std::vector<double> errors;
    std::vector<char> within;
    size_t count = 0;
    double sum = 0.0;
    for (const ControlPair& pair : pairs_) {
      errors.push_back(RelativeError(pair, candidate, bend_m_));
      within.push_back(errors.back() <= 1.0 ? 1 : 0);
      count += errors.back() <= 1.0 ? 1 : 0;
      sum += std::min(errors.back() * errors.back(), 1.0);
    }
    if (count > most_) rival_ = false;
    if (count == most_ && within != within_) rival_ = true;
    if (count > most_ || (count == most_ && sum < least_sum_)) {
      most_ = count;
      least_sum_ = sum;
      within_ = within;
      by_count_ = candidate;
    }
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    const double quantile = sorted[Majority() - 1];
    if (quantile < least_quantile_) {
      least_quantile_ = quantile;
      by_quantile_ = candidate;
    }
  }

  ControlSimilarity Best() const {
    ControlSimilarity best;
    // Three of four agree with every triple, when the error is one of height; but not when it is horizontal.
    const bool three_of_four = pairs_.size() == 4 && most_ == 3 && !rival_;
    if (most_ >= Majority() || three_of_four) {
      best.enu_from_model = by_count_;
      best.agrees = within_;
      return best;
    }
    best.enu_from_model = by_quantile_;
    for (const ControlPair& pair : pairs_) best.agrees.push_back(RelativeError(pair, by_quantile_, bend_m_) <= 2.0 * least_quantile_ ? 1 : 0);
    return best;
  }

 private:
  // Three pairs agree with most triples by themselves.
  size_t Majority() const { return std::min(pairs_.size(), (pairs_.size() + 4) / 2); }

  const std::vector<ControlPair>& pairs_;
  double bend_m_;
  size_t most_ = 0;
  double least_sum_ = 0.0, least_quantile_ = std::numeric_limits<double>::infinity();
  bool rival_ = false;  // other pairs agree as well with another similarity
  std::vector<char> within_;
  geo::Similarity3d by_count_, by_quantile_;
};

}  // namespace

Matrix3d ControlSimilarity::CovarianceAt(const Vector3d& x_in_enu) const {
  const Eigen::Matrix<double, 3, 7> jacobian = bundle::SimilarityJacobian(x_in_enu - middle);
  return jacobian * covariance * jacobian.transpose();
}

ControlSimilarity FitControlSimilarity(const std::vector<ControlPair>& pairs) {
  std::vector<size_t> full;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (HasHeight(pairs[i])) full.push_back(i);
  }
  ControlSimilarity fit;
  if (full.size() < 3) {
    fit.failure = SimilarityFailure::kTooFew;
    return fit;
  }
  TripleSearch search(pairs, std::min(kMaxBend_m, kBend * ExtentOf(pairs)));
  bool any = false;
  for (const Triple& triple : TriplesOf(full)) {
    geo::Similarity3d candidate;
    if (!ByThree(pairs, triple, &candidate)) continue;
    search.Try(candidate);
    any = true;
  }
  if (any) fit = search.Best();
  std::vector<Vector3d> places;
  for (const size_t i : full) {
    if (any && fit.agrees[i] != 0) places.push_back(pairs[i].in_enu);
  }
  if (places.size() < 3 || OnOneLineOf(places)) {
    fit.failure = SimilarityFailure::kOnLine;
    return fit;
  }
  RefineSimilarity(pairs, &fit);
  return fit;
}

}  // namespace skyquilt::prepare::control
