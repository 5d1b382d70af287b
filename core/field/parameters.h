// The learned numbers of one field. In the program their one owner is render::TrainedField; training and rendering read
// them there.
#pragma once

#include <cstddef>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::field {

// A buffer of n zeros on huge pages where the system has them: random access to tables of megabytes misses the TLB at every corner on pages of
// 4 KiB. What was in it is lost.
void AssignTable(std::vector<float>* table, size_t n);

struct Parameters {
  std::vector<float> grid;      // HashField::GridParameters()
  std::vector<float> networks;  // HashField::NetworkParameters()

  // All zero, laid out for training. To keep that, copy into the buffers instead of replacing them.
  void Allocate(const HashField& field);
  size_t Count() const { return grid.size() + networks.size(); }
};

}  // namespace skyquilt::field
