#include "worker/rays/photo_pyramid.h"

#include <algorithm>
#include <numeric>

namespace skyquilt::worker {
namespace {

std::array<double, kPyramidLevels> Normalized(const std::vector<double>& shares) {
  std::array<double, kPyramidLevels> all = {};
  std::copy_n(shares.begin(), std::min<size_t>(shares.size(), all.size()), all.begin());
  const double sum = std::accumulate(all.begin(), all.end(), 0.0);
  if (!(sum > 0.0)) return {1.0};
  for (double& share : all) share /= sum;
  return all;
}

}  // namespace

PhotoPyramid::PhotoPyramid(const std::vector<double>& shares, const std::vector<double>& first, double until, double progress) {
  const std::array<double, kPyramidLevels> last = Normalized(shares);
  const std::array<double, kPyramidLevels> begin = first.empty() ? last : Normalized(first);
  const double part = until > 0.0 ? std::clamp(progress / until, 0.0, 1.0) : 1.0;
  double sum = 0.0;
  for (size_t l = 0; l < upper_.size(); ++l) upper_[l] = sum += (1.0 - part) * begin[l] + part * last[l];
  // Rounding must not leave a gap at the end, nor make the last level with a share unreachable.
  for (size_t l = upper_.size(); l-- > 0;) {
    const bool used = part < 1.0 ? begin[l] > 0.0 || last[l] > 0.0 : last[l] > 0.0;
    upper_[l] = 1.0;
    if (used) break;
  }
}

int PhotoPyramid::Draw(base::Random& random) const {
  if (upper_.front() >= 1.0) return 0;
  const auto drawn = static_cast<double>(random.Uniform());
  int level = 0;
  while (level + 1 < kPyramidLevels && drawn >= upper_[static_cast<size_t>(level)]) ++level;
  return level;
}

PyramidRange RangeOf(const std::vector<double>& shares, const std::vector<double>& first) {
  PyramidRange range{kPyramidLevels, 0};
  for (const auto* list : {&shares, &first}) {
    if (list->empty() && (list == &first || !first.empty())) continue;
    const std::array<double, kPyramidLevels> all = Normalized(*list);
    for (int l = 0; l < kPyramidLevels; ++l) {
      if (!(all[static_cast<size_t>(l)] > 0.0)) continue;
      range.finest = std::min(range.finest, l);
      range.coarsest = std::max(range.coarsest, l);
    }
  }
  return range;
}

}  // namespace skyquilt::worker
