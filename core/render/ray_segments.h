// Cuts a ray into segments that need the same blocks each, so that a scene larger than memory can be rendered segment by segment.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/render/ground_index.h"
#include "core/render/ray_engine.h"

namespace skyquilt::render {

struct RaySegment {
  double t_far = 0.0;  // metres; a segment begins at the end of the previous one, the first at 0; the last ends at infinity
  int set = 0;         // number of its set of blocks, for RaySegments::Blocks
};

// The sets of blocks that segments of rays in one scene need. Thread-safe.
class RaySegments {
 public:
  // Only the blocks' boxes and maps are used, so they need not be loaded. They must outlive this.
  explicit RaySegments(std::vector<const TrainedField*> blocks);

  // The blocks of a set, ascending; empty where only the context is. The span stays valid.
  std::span<const int> Blocks(int set) const;

 private:
  friend class RaySplitter;
  int SetOf(const std::vector<int>& blocks) const;

  std::vector<const TrainedField*> blocks_;
  GroundIndex index_;
  mutable std::mutex mutex_;
  mutable std::map<std::vector<int>, int> numbers_;
  mutable std::vector<const std::vector<int>*> sets_;  // keys of numbers_, by number
};

// Cuts rays on one thread. It remembers the sets that it has met, so that threads do not wait for each other. Its cost does not grow with the number
// of blocks, but with those that the ray passes.
class RaySplitter {
 public:
  // The segments must outlive it.
  explicit RaySplitter(const RaySegments& segments) : segments_(segments) {}

  // Appends the segments of a ray, front to back; at least one. Successive segments have different sets. A segment needs the blocks that have a
  // weight there, at any height; none where the ray is below or above all blocks, or outside its own interval.
  void Split(const Ray& ray, std::vector<RaySegment>* segments);

 private:
  struct Hash {
    size_t operator()(const std::vector<int>& blocks) const;
  };
  int SetOf(const std::vector<int>& blocks);

  const RaySegments& segments_;
  std::unordered_map<std::vector<int>, int, Hash> known_;
  // Workspace of one ray.
  std::vector<int> near_, here_;
  std::vector<std::pair<geo::Interval, int>> over_;
  std::vector<double> changes_;
};

}  // namespace skyquilt::render
