#include "prepare/georeference/tags/photo_column.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include "core/linear/linear.h"
#include "prepare/georeference/tags/tag_checks.h"
#include "prepare/georeference/tags/tags.h"

namespace skyquilt::prepare::georeference {

using Eigen::Vector3d;

namespace {

constexpr double kColumnRatio = 0.25;
constexpr double kFromVertical_deg = 15.0;
constexpr double kSameCourse = 0.95;  // correlation of tagged heights with places along the line
constexpr size_t kFewestHeights = 4;

// The tags in ENU about their middle, heights as far as they say anything.
std::vector<Tag> TagsOf(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<size_t> order(photos.size());
  std::iota(order.begin(), order.end(), size_t{0});
  return CollectTags(photos, order, MedianPosition(photos), JudgeHeights(photos));
}

// Pearson's, over the tags with a height; 0 for fewer than kFewestHeights.
double CorrelationWithHeights(const std::vector<Tag>& tags, const std::vector<Vector3d>& centres, const Vector3d& axis) {
  std::vector<Eigen::Vector2d> pairs;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (size_t k = 0; k < tags.size(); ++k) {
    if (!std::isfinite(tags[k].x_in_enu.z())) continue;
    pairs.emplace_back(axis.dot(centres[k]), tags[k].x_in_enu.z());
    mean += pairs.back();
  }
  if (pairs.size() < kFewestHeights) return 0.0;
  mean /= static_cast<double>(pairs.size());
  double product = 0.0;
  Eigen::Vector2d squares = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& pair : pairs) {
    const Eigen::Vector2d from_mean = pair - mean;
    product += from_mean.x() * from_mean.y();
    squares += from_mean.cwiseAbs2();
  }
  const double size = std::sqrt(squares.x() * squares.y());
  return size > 0.0 ? product / size : 0.0;
}

}  // namespace

bool CamerasAboveOneAnother(const std::vector<input::PreparedPhoto>& photos, const Vector3d& up) {
  const std::vector<Tag> tags = TagsOf(photos);
  std::vector<Vector3d> centres;
  Vector3d mean = Vector3d::Zero();
  for (const Tag& tag : tags) {
    centres.push_back(photos[tag.photo].cam_from_model.OriginInSource());
    mean += centres.back() / static_cast<double>(tags.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& centre : centres) spread += (centre - mean) * (centre - mean).transpose();
  const linear::EigenPairs<3> eigen = linear::SymmetricEigen(spread);
  if (!(eigen.values[2] > 0.0) || !(eigen.values[0] + eigen.values[1] <= kColumnRatio * kColumnRatio * eigen.values[2])) return false;
  const Vector3d axis = eigen.vectors.col(2);
  const bool vertical = std::abs(axis.dot(up)) >= std::cos(kFromVertical_deg * std::numbers::pi / 180.0);
  return vertical || std::abs(CorrelationWithHeights(tags, centres, axis)) >= kSameCourse;
}

bool TagsFormColumn(const std::vector<input::PreparedPhoto>& photos) {
  std::vector<Tag> tags = TagsOf(photos);
  std::erase_if(tags, [](const Tag& tag) { return !std::isfinite(tag.x_in_enu.z()); });
  Vector3d mean = Vector3d::Zero(), squares = Vector3d::Zero();
  for (const Tag& tag : tags) mean += tag.x_in_enu / static_cast<double>(tags.size());
  for (const Tag& tag : tags) squares += (tag.x_in_enu - mean).cwiseAbs2();
  return squares.z() > 0.0 && squares.x() + squares.y() <= kColumnRatio * kColumnRatio * squares.z();
}

}  // namespace skyquilt::prepare::georeference
