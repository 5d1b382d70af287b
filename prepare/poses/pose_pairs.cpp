#include "prepare/poses/pose_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"

namespace skyquilt::prepare::poses {
namespace {

// Distance to the scene over that to the sixth nearest photo, at an overlap of two thirds and a field of view of 60 degrees. Not the nearest: a rig
// may have five cameras at one place.
constexpr double kDepthPerSpacing = 2.0;
constexpr size_t kSpacingNeighbor = 6;
constexpr double kItself = std::numeric_limits<double>::infinity();

struct Pose {
  Eigen::Vector3d centre, direction;
};

std::vector<double> SquaredDistances(const std::vector<Pose>& poses, uint32_t photo, double depth) {
  std::vector<double> costs(poses.size());
  for (size_t other = 0; other < poses.size(); ++other) {
    costs[other] =
        (poses[other].centre - poses[photo].centre).squaredNorm() + depth * depth * (poses[other].direction - poses[photo].direction).squaredNorm();
  }
  costs[photo] = kItself;
  return costs;
}

}  // namespace

PhotoPairs PairsByPose(const std::vector<geo::Rigid3d>& cam_from_world, const PairRules& rules) {
  const size_t n = cam_from_world.size();
  if (n < std::max<size_t>(rules.all_below, 2)) return AllPairs(n);
  std::vector<Pose> poses;
  for (const geo::Rigid3d& pose : cam_from_world) {
    poses.push_back({pose.OriginInSource(), pose.rotation.conjugate() * Eigen::Vector3d::UnitZ()});
  }
  std::vector<double> spacing;
  for (uint32_t photo = 0; photo < n; ++photo) {
    base::ThrowIfCancelled();
    std::vector<double> costs = SquaredDistances(poses, photo, 0.0);
    const auto neighbor = costs.begin() + static_cast<std::ptrdiff_t>(std::min(kSpacingNeighbor, n - 1) - 1);
    std::nth_element(costs.begin(), neighbor, costs.end());
    spacing.push_back(std::sqrt(*neighbor));
  }
  const double depth = kDepthPerSpacing * base::Median(spacing);
  PhotoPairs pairs;
  std::vector<uint32_t> order(n);
  for (uint32_t photo = 0; photo < n; ++photo) {
    base::ThrowIfCancelled();
    const std::vector<double> costs = SquaredDistances(poses, photo, depth);
    std::iota(order.begin(), order.end(), 0U);
    const size_t k = std::min(rules.neighbors, n - 1);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(k), order.end(),
                      [&](uint32_t a, uint32_t b) { return costs[a] != costs[b] ? costs[a] < costs[b] : a < b; });
    for (size_t i = 0; i < k; ++i) pairs.push_back(MakePair(photo, order[i]));
  }
  SortPairs(pairs);
  ConnectGroups(
      n, rules.links, [&](uint32_t photo) { return SquaredDistances(poses, photo, depth); }, pairs);
  return pairs;
}

}  // namespace skyquilt::prepare::poses
