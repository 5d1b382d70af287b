#include "viewer/queries/volume_base.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/linear/linear.h"

namespace skyquilt::viewer {
namespace {

constexpr int kPatchSide = 5;  // rays
constexpr size_t kPatchRays = size_t{kPatchSide} * kPatchSide;
constexpr size_t kFewestHits = 5;
constexpr double kFlattest = 1e-6;  // of the squares of the corners' distances: the smaller axis relative to the larger one

double MedianOfFinite(const double* first, size_t count, size_t fewest) {
  std::vector<double> finite;
  std::copy_if(first, first + count, std::back_inserter(finite), [](double value) { return std::isfinite(value); });
  if (finite.size() < fewest) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = finite.begin() + static_cast<std::ptrdiff_t>(finite.size() / 2);
  std::nth_element(finite.begin(), middle, finite.end());
  return *middle;
}

}  // namespace

CornerPatches::CornerPatches(const std::vector<Eigen::Vector2d>& polygon, double spacing_m)
    : polygon_(polygon),
      spacing_m_(spacing_m),
      heights_m_(polygon.size() * kPatchRays, std::numeric_limits<double>::quiet_NaN()),
      spreads_m_(heights_m_) {}

size_t CornerPatches::rays() const {
  return heights_m_.size();
}

Eigen::Vector2d CornerPatches::Place(size_t ray) const {
  const auto in_patch = static_cast<int>(ray % kPatchRays);
  const Eigen::Vector2d step(in_patch % kPatchSide - kPatchSide / 2, in_patch / kPatchSide - kPatchSide / 2);
  return polygon_[ray / kPatchRays] + spacing_m_ * step;
}

void CornerPatches::Take(size_t ray, double height_m, double spread_m) {
  heights_m_[ray] = height_m;
  spreads_m_[ray] = spread_m;
}

std::vector<CornerPatches::Corner> CornerPatches::Corners() const {
  std::vector<Corner> corners;
  for (size_t i = 0; i < polygon_.size(); ++i) {
    const double height = MedianOfFinite(&heights_m_[i * kPatchRays], kPatchRays, kFewestHits);
    if (std::isfinite(height)) corners.push_back({polygon_[i], height, MedianOfFinite(&spreads_m_[i * kPatchRays], kPatchRays, 1)});
  }
  return corners;
}

BasePlane CornerPatches::FitPlane(const Eigen::Vector2d& centroid) const {
  const std::vector<Corner> corners = Corners();
  if (corners.size() < 3) {
    throw BadMessage("a base plane needs at least three corners that lie on a surface, and there are " + std::to_string(corners.size()) +
                     "; move the corners, or choose another base");
  }
  const auto n = static_cast<double>(corners.size());
  BasePlane plane;
  for (const Corner& corner : corners) {
    plane.middle += corner.place / n;
    plane.height_m += corner.height_m / n;
  }
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Corner& corner : corners) {
    const Eigen::Vector2d d = corner.place - plane.middle;
    normal += d * d.transpose();
    right += d * (corner.height_m - plane.height_m);
  }
  // The product of the eigenvalues relative to the square of their sum.
  if (!(linear::Determinant(normal) > kFlattest * normal.trace() * normal.trace())) {
    throw BadMessage("the corners that lie on a surface are almost on a line, which gives no base plane; add a corner, or choose another base");
  }
  const Eigen::Matrix2d inverse = linear::Inverse(normal);
  plane.slope = inverse * right;
  // The height at the centroid is a weighted sum of the corners' heights, whose errors are independent.
  double variance = 0.0;
  for (const Corner& corner : corners) {
    const double weight = 1.0 / n + (centroid - plane.middle).dot(inverse * (corner.place - plane.middle));
    variance += weight * weight * corner.spread_m * corner.spread_m;
  }
  plane.sigma_m = std::sqrt(variance);
  return plane;
}

BasePlane CornerPatches::Lowest() const {
  const std::vector<Corner> corners = Corners();
  if (corners.empty()) throw BadMessage("no corner of the outline lies on a surface; move a corner, or choose another base");
  const auto lowest = std::min_element(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.height_m < b.height_m; });
  BasePlane plane;
  plane.middle = lowest->place;
  plane.height_m = lowest->height_m;
  plane.sigma_m = lowest->spread_m;
  return plane;
}

}  // namespace skyquilt::viewer
