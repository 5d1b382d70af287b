#include "core/render/ray_segments.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace skyquilt::render {

RaySegments::RaySegments(std::vector<const TrainedField*> blocks) : blocks_(std::move(blocks)) {}

void RaySegments::Split(const Ray& ray, std::vector<RaySegment>* segments) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  thread_local std::vector<std::pair<geo::Interval, int>> over;
  thread_local std::vector<double> changes;
  thread_local std::vector<int> here;
  over.clear();
  changes.assign({0.0, kInfinity});
  for (size_t k = 0; k < blocks_.size(); ++k) {
    const geo::Interval interval = BlendInterval(*blocks_[k], ray);
    if (interval.Empty()) continue;
    over.emplace_back(interval, static_cast<int>(k));
    changes.push_back(interval.t_near);
    changes.push_back(interval.t_far);
  }
  std::sort(changes.begin(), changes.end());
  changes.erase(std::unique(changes.begin(), changes.end()), changes.end());
  const size_t first = segments->size();
  for (size_t i = 0; i + 1 < changes.size(); ++i) {
    here.clear();
    const Window window{changes[i], changes[i + 1]};
    for (const auto& [interval, k] : over) {
      if (window.Overlaps(interval)) here.push_back(k);
    }
    const int set = SetOf(here);
    if (segments->size() > first && segments->back().set == set) {
      segments->back().t_far = changes[i + 1];
    } else {
      segments->push_back({changes[i + 1], set});
    }
  }
}

std::span<const int> RaySegments::Blocks(int set) const {
  const std::lock_guard lock(mutex_);
  return *sets_[static_cast<size_t>(set)];
}

int RaySegments::SetOf(const std::vector<int>& blocks) const {
  const std::lock_guard lock(mutex_);
  const auto [at, is_new] = numbers_.try_emplace(blocks, static_cast<int>(sets_.size()));
  if (is_new) sets_.push_back(&at->first);
  return at->second;
}

}  // namespace skyquilt::render
