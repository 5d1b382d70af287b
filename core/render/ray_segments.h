// Where the blocks over a ray change: between two changes always the same fields are needed.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "core/render/ray_engine.h"

namespace skyquilt::render {

struct RaySegment {
  double t_far = 0.0;  // metres; the segment begins where the one before it ends, the first at 0, and the last ends at infinity
  int set = 0;         // of blocks, see RaySegments::Blocks
};

// Of one scene. Split may be called by many threads at once.
class RaySegments {
 public:
  // Only places are looked at; the blocks must outlive this.
  explicit RaySegments(std::vector<const TrainedField*> blocks);

  // Appends the segments of a ray, front to back; at least one. Neighbours have different sets.
  void Split(const Ray& ray, std::vector<RaySegment>* segments) const;
  // Ascending; empty where only the context is. The span stays good.
  std::span<const int> Blocks(int set) const;

 private:
  int SetOf(const std::vector<int>& blocks) const;

  std::vector<const TrainedField*> blocks_;
  mutable std::mutex mutex_;
  mutable std::map<std::vector<int>, int> numbers_;
  mutable std::vector<const std::vector<int>*> sets_;  // keys of numbers_, by number
};

}  // namespace skyquilt::render
