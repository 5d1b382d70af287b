#include "partition/vertical_range.h"

#include <algorithm>

#include "core/base/errors.h"
#include "partition/percentile.h"

namespace skyquilt::partition {
namespace {

std::vector<double> HeightsInside(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  std::vector<double> heights;
  for (const Eigen::Vector3d& x : points) {
    if ((x.head<2>().array() >= low.array()).all() && (x.head<2>().array() <= high.array()).all()) heights.push_back(x.z());
  }
  return heights;
}

}  // namespace

std::optional<std::pair<double, double>> VerticalRange(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low,
                                                       const Eigen::Vector2d& high, double gsd_m, const PartitionOptions& options) {
  SKYQUILT_CHECK(gsd_m > 0.0, std::to_string(gsd_m));
  constexpr size_t kEnough = 50;
  const std::vector<double> heights = HeightsInside(points, low, high);
  if (heights.empty()) return std::nullopt;
  double bottom = Percentile(heights, 0.005);
  double top = Percentile(heights, 0.998);
  if (heights.size() < kEnough) {
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    const std::vector<double> around = HeightsInside(points, low - (high - low), high + (high - low));
    bottom = std::min(*least, Percentile(around, 0.25));
    top = std::max(*most, Percentile(around, 0.75));
  }
  bottom -= std::clamp(options.z_margin_below_m, 8.0 * gsd_m, 40.0 * gsd_m);
  top += std::clamp(options.z_margin_above_m, 8.0 * gsd_m, 40.0 * gsd_m);
  return std::make_pair(bottom, top);
}

}  // namespace skyquilt::partition
