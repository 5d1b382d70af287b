#include "partition/vertical_range.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "partition/partition_options.h"

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
                                                       const Eigen::Vector2d& high, double gsd_m) {
  SKYQUILT_CHECK(gsd_m > 0.0, std::to_string(gsd_m));
  constexpr size_t kEnough = 50;
  const std::vector<double> heights = HeightsInside(points, low, high);
  if (heights.empty()) return std::nullopt;
  double bottom = base::Quantile(heights, 0.005);
  double top = base::Quantile(heights, 0.998);
  if (heights.size() < kEnough) {
    const auto [least, most] = std::minmax_element(heights.begin(), heights.end());
    const std::vector<double> around = HeightsInside(points, low - (high - low), high + (high - low));
    bottom = std::min(*least, base::Quantile(around, 0.25));
    top = std::max(*most, base::Quantile(around, 0.75));
  }
  bottom -= std::clamp(kFreeHeight_m, 8.0 * gsd_m, 40.0 * gsd_m);
  top += std::clamp(kFreeHeight_m, 8.0 * gsd_m, 40.0 * gsd_m);
  return std::make_pair(bottom, top);
}

double ShareWithoutSparsePoints(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  if (points.empty()) return 1.0;
  Eigen::Vector2d first = points.front().head<2>(), last = first;
  for (const Eigen::Vector3d& x : points) {
    first = first.cwiseMin(x.head<2>());
    last = last.cwiseMax(x.head<2>());
  }
  first = first.cwiseMax(low);
  last = last.cwiseMin(high);
  if (!(last.array() > first.array()).all()) return 1.0;
  const auto n = static_cast<double>(HeightsInside(points, first, last).size());
  const int side = std::clamp(static_cast<int>(std::sqrt(n / 8.0)), 1, 32);
  std::vector<uint8_t> filled(static_cast<size_t>(side) * static_cast<size_t>(side), 0);
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector2d at = (x.head<2>() - first).cwiseQuotient(last - first);
    if ((at.array() < 0.0).any() || (at.array() > 1.0).any()) continue;
    const auto cell = [side](double share) { return static_cast<size_t>(std::min(side - 1, static_cast<int>(share * side))); };
    filled[cell(at.y()) * static_cast<size_t>(side) + cell(at.x())] = 1;
  }
  return static_cast<double>(std::count(filled.begin(), filled.end(), 0)) / static_cast<double>(filled.size());
}

}  // namespace skyquilt::partition
