// Numbers 0 to n - 1 in groups that are joined step by step (Tarjan, Efficiency of a good but not linear set union algorithm, 1975).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace skyquilt::base {

class DisjointSets {
 public:
  // Each number is a group of its own.
  explicit DisjointSets(size_t n) : parent_(n), count_(n) { std::iota(parent_.begin(), parent_.end(), 0U); }

  // The smallest number of the group, the same for all its members.
  uint32_t Root(uint32_t i) {
    // Halving the path keeps later searches short.
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void Join(uint32_t a, uint32_t b) {
    a = Root(a);
    b = Root(b);
    if (a == b) return;
    --count_;
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // Groups.
  size_t count() const { return count_; }

 private:
  std::vector<uint32_t> parent_;
  size_t count_;
};

}  // namespace skyquilt::base
