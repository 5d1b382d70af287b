#include "buildings/candidates/matched_points.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kBorder_m = 0.5;

// Of the roof above the ground; not positive when one of them is unknown.
double RoofHeight(const Candidate& candidate, const PointCloud& cloud, const GroundGrid& ground) {
  std::vector<double> heights;
  for (const uint32_t i : candidate.roof) {
    const Eigen::Vector3d at = cloud.At(i);
    const double height = at.z() - ground.At(at.head<2>());
    if (std::isfinite(height)) heights.push_back(height);
  }
  return heights.empty() ? 0.0 : base::Median(std::move(heights));
}

}  // namespace

std::vector<MatchedPoints> CountMatched(std::span<const Candidate> candidates, std::span<const Eigen::Vector3d> points, const PointCloud& cloud,
                                        const GroundGrid& ground, base::ThreadPool& threads) {
  std::vector<MatchedPoints> counts(candidates.size());
  threads.ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t task, int) {
    const auto c = static_cast<size_t>(task);
    const Polygon& outline = candidates[c].outline;
    const double roof_m = RoofHeight(candidates[c], cloud, ground);
    if (!(roof_m > 0.0)) return;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : outline.outer) box.extend(corner);
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector2d at = point.head<2>();
      if (!box.contains(at) || !Contains(outline, at) || DistanceToBorder(outline, at) <= kBorder_m) continue;
      const double height = point.z() - ground.At(at);
      if (std::isfinite(height)) ++(height < 0.5 * roof_m ? counts[c].low : counts[c].high);
    }
  });
  return counts;
}

}  // namespace skyquilt::buildings
