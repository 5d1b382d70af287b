// Workspaces of networks: one for all fields of the same shape, where only one field is evaluated at a time. One for each of thousands of blocks
// would take gigabytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::render {

// Not thread-safe.
class ScratchPool {
 public:
  // The number of the workspace for a field, with room for field::kChunk samples.
  size_t For(const field::HashField& f) {
    const Shape shape{f.config().hidden, f.DensityHiddenRows(), f.ColorInputRows(), f.config().color_hidden_layers};
    const auto same = std::find_if(scratch_.begin(), scratch_.end(), [&](const auto& one) { return one.first == shape; });
    if (same != scratch_.end()) return static_cast<size_t>(same - scratch_.begin());
    scratch_.emplace_back(shape, field::Activations{}).second.Reserve(f, field::kChunk);
    return scratch_.size() - 1;
  }
  // Valid until the next call of For.
  const field::Activations& operator[](size_t number) const { return scratch_[number].second; }

 private:
  // What the size of field::Activations depends on.
  struct Shape {
    int64_t hidden = 0, density_rows = 0, color_inputs = 0, color_layers = 0;
    bool operator==(const Shape&) const = default;
  };
  std::vector<std::pair<Shape, field::Activations>> scratch_;
};

}  // namespace skyquilt::render
