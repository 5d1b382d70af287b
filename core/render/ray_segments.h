// Cuts a ray into segments that need the same blocks each, so that a scene larger than memory can be rendered segment by segment.
#pragma once

#include <map>
#include <mutex>
#include <span>
#include <vector>

#include "core/render/ray_engine.h"

namespace skyquilt::render {

struct RaySegment {
  double t_far = 0.0;  // metres; a segment begins at the end of the previous one, the first at 0; the last ends at infinity
  int set = 0;         // number of its set of blocks, for RaySegments::Blocks
};

// The segments of rays in one scene. Thread-safe.
class RaySegments {
 public:
  // Only the blocks' boxes are used, so they need not be loaded. They must outlive this.
  explicit RaySegments(std::vector<const TrainedField*> blocks);

  // Appends the segments of a ray, front to back; at least one. Successive segments have different sets.
  void Split(const Ray& ray, std::vector<RaySegment>* segments) const;
  // The blocks of a set, ascending; empty where only the context is. The span stays valid.
  std::span<const int> Blocks(int set) const;

 private:
  int SetOf(const std::vector<int>& blocks) const;

  std::vector<const TrainedField*> blocks_;
  mutable std::mutex mutex_;
  mutable std::map<std::vector<int>, int> numbers_;
  mutable std::vector<const std::vector<int>*> sets_;  // keys of numbers_, by number
};

}  // namespace skyquilt::render
