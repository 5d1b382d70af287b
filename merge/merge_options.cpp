#include "merge/merge_options.h"

namespace skyquilt::merge {

std::vector<config::Field<MergeOptions>> MergeOptions::Fields() {
  using config::Range;
  using O = MergeOptions;
  return {
      {"storage", &O::storage, Range::OneOf({"fp32", "bf16", "fp16"}),
       "how the hash tables are kept in the scene: fp32 as they were trained, bf16 or fp16 in half the bytes (what is too large becomes the largest "
       "number)"},
      {"borders", &O::borders, Range::OneOf({"smooth", "hard"}),
       "smooth: neighbouring blocks are blended across their margins; hard: every block ends at its face and the next one begins there"},
  };
}

void MergeOptions::Check() const {
  config::CheckRanges("merge", *this);
}

checkpoint::Precision MergeOptions::Storage() const {
  if (storage == "bf16") return checkpoint::Precision::kBfloat16;
  return storage == "fp16" ? checkpoint::Precision::kFloat16 : checkpoint::Precision::kFloat32;
}

}  // namespace skyquilt::merge
