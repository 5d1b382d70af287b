#include "core/field/parameters.h"

#include "core/base/system.h"

namespace skyquilt::field {

void AssignTable(std::vector<float>* table, size_t n) {
  table->clear();
  table->reserve(n);
  base::AdviseHugePages(table->data(), n * sizeof(float));
  table->assign(n, 0.0F);
}

void Parameters::Allocate(const HashField& field) {
  AssignTable(&grid, static_cast<size_t>(field.GridParameters()));
  networks.assign(static_cast<size_t>(field.NetworkParameters()), 0.0F);
}

}  // namespace skyquilt::field
