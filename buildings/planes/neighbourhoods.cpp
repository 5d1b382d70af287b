#include "buildings/planes/neighbourhoods.h"

#include <algorithm>

#include "buildings/planes/plane_sums.h"
#include "buildings/planes/point_grid.h"
#include "core/base/cancel.h"

namespace skyquilt::buildings {
namespace {

constexpr size_t kLeastForPlane = 5;  // neighbours
constexpr size_t kTaskPoints = 8192;

}  // namespace

std::vector<Neighbourhood> FindNeighbourhoods(const PointCloud& cloud, std::span<const uint32_t> chosen, double reach_m, base::ThreadPool& threads) {
  std::vector<Neighbourhood> result(chosen.size());
  const PointGrid grid(cloud, chosen, reach_m);
  threads.ParallelFor(static_cast<int64_t>((chosen.size() + kTaskPoints - 1) / kTaskPoints), [&](int64_t task, int) {
    if (base::CancelRequested()) return;
    std::vector<PointGrid::Found> found;
    const size_t begin = static_cast<size_t>(task) * kTaskPoints;
    for (size_t p = begin; p < std::min(chosen.size(), begin + kTaskPoints); ++p) {
      Neighbourhood& of_point = result[p];
      grid.Near(static_cast<uint32_t>(p), reach_m, kMostNeighbours + 1, &found);
      PlaneSums sums;
      for (const PointGrid::Found& near : found) {
        sums.Add(cloud.points[chosen[near.place]].position);
        if (near.place != p) of_point.near[of_point.n++] = near.place;
      }
      of_point.normal = cloud.points[chosen[p]].normal;
      if (of_point.n < kLeastForPlane) continue;
      const FittedPlane plane = sums.Fit(of_point.normal.cast<double>());
      of_point.normal = plane.normal.cast<float>();
      of_point.roughness = static_cast<float>(plane.roughness);
    }
  });
  base::ThrowIfCancelled();
  return result;
}

}  // namespace skyquilt::buildings
