#include "bench/poses/survey_size.h"

#include <Eigen/Core>
#include <algorithm>
#include <numeric>

namespace skyquilt::bench {

std::vector<simulate::PhotoPlan> MiddlePhotos(std::vector<simulate::PhotoPlan> photos, size_t n) {
  if (n >= photos.size()) return photos;
  std::vector<Eigen::Vector2d> at;
  at.reserve(photos.size());
  for (const simulate::PhotoPlan& photo : photos) at.emplace_back(photo.cam_from_enu.OriginInSource().head<2>());
  Eigen::Vector2d min = at.front(), max = at.front();
  for (const Eigen::Vector2d& x : at) {
    min = min.cwiseMin(x);
    max = max.cwiseMax(x);
  }
  const Eigen::Vector2d middle = 0.5 * (min + max), half = (0.5 * (max - min)).cwiseMax(1e-6);
  const auto reach = [&](size_t i) { return (at[i] - middle).cwiseQuotient(half).cwiseAbs().maxCoeff(); };
  std::vector<size_t> nearest(photos.size());
  std::iota(nearest.begin(), nearest.end(), size_t{0});
  std::stable_sort(nearest.begin(), nearest.end(), [&](size_t a, size_t b) { return reach(a) < reach(b); });
  nearest.resize(n);
  std::sort(nearest.begin(), nearest.end());
  std::vector<simulate::PhotoPlan> chosen;
  chosen.reserve(n);
  for (const size_t i : nearest) chosen.push_back(std::move(photos[i]));
  return chosen;
}

}  // namespace skyquilt::bench
