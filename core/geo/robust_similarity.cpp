#include "core/geo/robust_similarity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/linear/linear.h"

namespace skyquilt::geo {
namespace {

using Points = Eigen::Matrix3Xd;

constexpr const char* kTooFew = "fewer than 3 matches with finite positions";
constexpr const char* kOnePlace = "all matches are at one place, so scale and rotation are undetermined";
constexpr const char* kOneLine = "all matches are on one line, so the rotation about it is undetermined";
constexpr const char* kNoAgreement = "no 3 matches agree on one similarity transform";

// Points count as a line when their second largest spread is below this part of their largest.
constexpr double kLineRatio = 1e-4;
constexpr double kSampleLineRatio = 1e-3;
// Largest accepted standard error of the roll about the longest direction (radians) and of the scale (relative).
constexpr double kMaxStandardError = 0.1;
constexpr double kConfidence = 1.0 - 1e-6;
constexpr int kRefitRounds = 10;

// Standard deviations of the points along their principal directions, largest first.
Eigen::Vector3d Spread(const Points& points) {
  const Points centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d products = centred * centred.transpose() / static_cast<double>(points.cols());
  return linear::SymmetricEigen(products).values.cwiseMax(0.0).cwiseSqrt().reverse();
}

// Why points of this shape cannot determine a similarity; null when they can.
const char* ShapeProblem(const Points& points, double line_ratio) {
  const Eigen::Vector3d spread = Spread(points);
  // A spread below the rounding error of the coordinates.
  if (!(spread[0] > 1e-12 * points.cwiseAbs().maxCoeff())) return kOnePlace;
  if (!(spread[1] > line_ratio * spread[0])) return kOneLine;
  return nullptr;
}

std::optional<Similarity3d> Umeyama(const Points& a, const Points& b) {
  const Eigen::Matrix4d matrix = linear::Similarity(a, b);
  if (!matrix.allFinite()) return std::nullopt;
  const Eigen::Matrix3d scaled = matrix.topLeftCorner<3, 3>();
  Similarity3d fit;
  fit.scale = std::cbrt(linear::Determinant(scaled));
  if (!(fit.scale > 0.0)) return std::nullopt;
  fit.rotation = Eigen::Quaterniond(scaled / fit.scale).normalized();
  fit.translation = matrix.topRightCorner<3, 1>();
  return fit;
}

Points Columns(const Points& points, const std::vector<Eigen::Index>& columns) {
  Points chosen(3, static_cast<Eigen::Index>(columns.size()));
  for (size_t i = 0; i < columns.size(); ++i) chosen.col(static_cast<Eigen::Index>(i)) = points.col(columns[i]);
  return chosen;
}

struct Candidate {
  Similarity3d fit;
  std::vector<Eigen::Index> inliers;
  // Sum of squared residuals, each limited to the threshold (MSAC). Unlike the number of inliers it also measures how well they fit.
  double cost = std::numeric_limits<double>::infinity();
};

class Search {
 public:
  Search(const Points& a, const Points& b, double threshold_m) : a_(a), b_(b), threshold_squared_(threshold_m * threshold_m) {}

  const Candidate& best() const { return best_; }

  void Try(const Points& sample_in_a, const Points& sample_in_b) {
    std::optional<Similarity3d> fit = Umeyama(sample_in_a, sample_in_b);
    if (!fit) return;
    Candidate candidate = Score(*fit);
    if (!(candidate.cost < best_.cost)) return;
    for (int round = 0; round < kRefitRounds && candidate.inliers.size() >= 3; ++round) {
      fit = Umeyama(Columns(a_, candidate.inliers), Columns(b_, candidate.inliers));
      if (!fit) break;
      Candidate refit = Score(*fit);
      if (!(refit.cost < candidate.cost)) break;
      candidate = std::move(refit);
    }
    best_ = std::move(candidate);
  }

 private:
  Candidate Score(const Similarity3d& fit) const {
    Candidate candidate;
    candidate.fit = fit;
    candidate.cost = 0.0;
    const Eigen::Matrix3d linear = fit.scale * fit.rotation.toRotationMatrix();
    for (Eigen::Index i = 0; i < a_.cols(); ++i) {
      const double squared = (b_.col(i) - (linear * a_.col(i) + fit.translation)).squaredNorm();
      if (squared <= threshold_squared_) candidate.inliers.push_back(i);
      candidate.cost += std::min(squared, threshold_squared_);
    }
    return candidate;
  }

  const Points& a_;
  const Points& b_;
  double threshold_squared_;
  Candidate best_;
};

// Number of samples after which one of three inliers has been drawn with probability kConfidence.
double DrawsNeeded(double inlier_share) {
  const double hit = inlier_share * inlier_share * inlier_share;
  if (hit >= 1.0) return 1.0;
  if (hit <= 0.0) return std::numeric_limits<double>::infinity();
  return std::log(1.0 - kConfidence) / std::log1p(-hit);
}

// Why the inliers do not determine scale and rotation, given their noise; null when they do.
const char* FitProblem(const Points& a, const Points& b, double scale, double rmse_m) {
  for (const Points* points : {&a, &b}) {
    if (const char* problem = ShapeProblem(*points, kLineRatio)) return problem;
  }
  const Eigen::Vector3d spread = Spread(b).cwiseMin(scale * Spread(a));
  const double noise_m = rmse_m / std::sqrt(3.0 * static_cast<double>(a.cols()));
  if (noise_m > kMaxStandardError * spread[0]) return kOnePlace;
  if (noise_m > kMaxStandardError * spread[1]) return kOneLine;
  return nullptr;
}

}  // namespace

RobustSimilarityFit FitSimilarityRobustly(const std::vector<Eigen::Vector3d>& points_in_a, const std::vector<Eigen::Vector3d>& points_in_b,
                                          const RobustSimilarityOptions& options) {
  SKYQUILT_CHECK(points_in_a.size() == points_in_b.size(),
                 std::to_string(points_in_a.size()) + " points against " + std::to_string(points_in_b.size()));
  SKYQUILT_CHECK(options.inlier_threshold_m > 0.0, "inlier_threshold_m " + std::to_string(options.inlier_threshold_m));
  RobustSimilarityFit result;
  result.inlier.assign(points_in_a.size(), 0);
  result.residual_m.assign(points_in_a.size(), std::numeric_limits<double>::quiet_NaN());

  std::vector<size_t> finite;
  for (size_t i = 0; i < points_in_a.size(); ++i) {
    if (points_in_a[i].allFinite() && points_in_b[i].allFinite()) finite.push_back(i);
  }
  if (finite.size() < 3) {
    result.reason = kTooFew;
    return result;
  }
  const auto n = static_cast<Eigen::Index>(finite.size());
  Points a(3, n);
  Points b(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    a.col(i) = points_in_a[finite[static_cast<size_t>(i)]];
    b.col(i) = points_in_b[finite[static_cast<size_t>(i)]];
  }
  for (const Points* points : {&a, &b}) {
    if (const char* problem = ShapeProblem(*points, kLineRatio)) {
      result.reason = problem;
      return result;
    }
  }

  Search search(a, b, options.inlier_threshold_m);
  search.Try(a, b);
  base::Random random(options.seed);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    if (iteration >= DrawsNeeded(static_cast<double>(search.best().inliers.size()) / static_cast<double>(n))) break;
    std::array<Eigen::Index, 3> sample;
    do {
      for (Eigen::Index& index : sample) index = random.Below(static_cast<uint32_t>(n));
    } while (sample[0] == sample[1] || sample[1] == sample[2] || sample[2] == sample[0]);
    const std::vector<Eigen::Index> columns(sample.begin(), sample.end());
    const Points sample_in_a = Columns(a, columns);
    const Points sample_in_b = Columns(b, columns);
    if (ShapeProblem(sample_in_a, kSampleLineRatio) || ShapeProblem(sample_in_b, kSampleLineRatio)) continue;
    search.Try(sample_in_a, sample_in_b);
  }

  const Candidate& best = search.best();
  if (best.inliers.size() < 3) {
    result.reason = kNoAgreement;
    return result;
  }
  result.b_from_a = best.fit;
  result.n_inliers = static_cast<int>(best.inliers.size());
  for (const size_t i : finite) result.residual_m[i] = (points_in_b[i] - best.fit * points_in_a[i]).norm();
  double sum = 0.0;
  for (const Eigen::Index i : best.inliers) {
    const size_t match = finite[static_cast<size_t>(i)];
    result.inlier[match] = 1;
    sum += result.residual_m[match] * result.residual_m[match];
  }
  result.rmse_m = std::sqrt(sum / result.n_inliers);
  if (const char* problem = FitProblem(Columns(a, best.inliers), Columns(b, best.inliers), best.fit.scale, result.rmse_m)) {
    result.reason = problem;
    return result;
  }
  result.ok = true;
  return result;
}

}  // namespace skyquilt::geo
