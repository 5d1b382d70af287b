// The size of one field's tables against those of several.
#pragma once

#include "bench/study/study.h"

namespace skyquilt::bench {

// log2 of the table size with which one field has about as many entries as all blocks of `divided` together; log2_table_size when it has no blocks.
int JoinedTableSize(const VariantResult& divided, int log2_table_size);

}  // namespace skyquilt::bench
