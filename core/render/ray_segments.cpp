#include "core/render/ray_segments.h"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace skyquilt::render {

RaySegments::RaySegments(std::vector<const TrainedField*> blocks) : blocks_(std::move(blocks)), index_(blocks_) {}

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

// FNV-1a by whole numbers.
size_t RaySplitter::Hash::operator()(const std::vector<int>& blocks) const {
  uint64_t hash = 14695981039346656037U;
  for (const int k : blocks) hash = (hash ^ static_cast<uint64_t>(k)) * 1099511628211U;
  return static_cast<size_t>(hash);
}

int RaySplitter::SetOf(const std::vector<int>& blocks) {
  const auto at = known_.find(blocks);
  if (at != known_.end()) return at->second;
  return known_.emplace(blocks, segments_.SetOf(blocks)).first->second;
}

void RaySplitter::Split(const Ray& ray, std::vector<RaySegment>* segments) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const geo::Interval reach = Intersection(segments_.index_.HeightInterval(ray), {std::max(0.0, ray.t_near), ray.t_far});
  segments_.index_.Find(ray, reach, &near_);
  over_.clear();
  changes_.assign({0.0, kInfinity});
  for (const int k : near_) {
    const geo::Interval interval = Intersection(BlendInterval(*segments_.blocks_[static_cast<size_t>(k)], ray), reach);
    if (interval.Empty()) continue;
    over_.emplace_back(interval, k);
    changes_.push_back(interval.t_near);
    changes_.push_back(interval.t_far);
  }
  std::sort(changes_.begin(), changes_.end());
  changes_.erase(std::unique(changes_.begin(), changes_.end()), changes_.end());
  const size_t first = segments->size();
  for (size_t i = 0; i + 1 < changes_.size(); ++i) {
    here_.clear();
    const Window window{changes_[i], changes_[i + 1]};
    for (const auto& [interval, k] : over_) {
      if (window.Overlaps(interval)) here_.push_back(k);
    }
    const int set = SetOf(here_);
    if (segments->size() > first && segments->back().set == set) {
      segments->back().t_far = changes_[i + 1];
    } else {
      segments->push_back({changes_[i + 1], set});
    }
  }
}

}  // namespace skyquilt::render
