#include "bench/study/joined_tables.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::bench {

int JoinedTableSize(const VariantResult& divided, int log2_table_size) {
  double entries = 0.0;
  for (const VariantField& field : divided.fields) {
    if (field.log2_table_size > 0) entries += std::exp2(field.log2_table_size);
  }
  return entries > 0.0 ? std::min(24, static_cast<int>(std::lround(std::log2(entries)))) : log2_table_size;
}

}  // namespace skyquilt::bench
