// The learned parameters of one field. They are owned by render::TrainedField; training and rendering use them there.
#pragma once

#include <cstddef>
#include <vector>

#include "core/field/hash_field.h"

namespace skyquilt::field {

// Replaces *table by n zeros, on huge pages where the system has them: with pages of 4 KiB, most random accesses to a large table miss the TLB.
void AssignTable(std::vector<float>* table, size_t n);

struct Parameters {
  std::vector<float> grid;      // HashField::GridParameters()
  std::vector<float> networks;  // HashField::NetworkParameters()

  // Allocates both with zeros, the grid by AssignTable. To keep its huge pages, copy into the buffers instead of replacing them.
  void Allocate(const HashField& field);
  size_t Count() const { return grid.size() + networks.size(); }
};

}  // namespace skyquilt::field
