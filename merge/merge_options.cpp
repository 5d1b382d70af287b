#include "merge/merge_options.h"

#include "merge/look.h"

namespace skyquilt::merge {

std::vector<config::Field<MergeOptions>> MergeOptions::Fields() {
  using config::Range;
  using O = MergeOptions;
  return {
      {"storage", &O::storage, Range::OneOf({"fp32", "bf16", "fp16"}),
       "number format of the hash tables in the scene file: fp32 as trained; bf16 and fp16 take half the bytes (values too large for the format are "
       "clamped)"},
      {"borders", &O::borders, Range::OneOf({"smooth", "hard"}),
       "smooth: neighbouring blocks are blended where their margins overlap; hard: no blending, every block ends at the faces of its box"},
      {"look", &O::look, Range(),
       "with train.appearance_codes: the photo, or with train.appearance_of = folder the folder, as whose photos the scene looks; several with "
       "weights "
       "are mixed, such as morning:0.5,noon:0.5; empty: the mean look"},
  };
}

void MergeOptions::Check() const {
  config::CheckRanges("merge", *this);
  ParseLook(look);
}

checkpoint::Precision MergeOptions::Storage() const {
  if (storage == "bf16") return checkpoint::Precision::kBfloat16;
  return storage == "fp16" ? checkpoint::Precision::kFloat16 : checkpoint::Precision::kFloat32;
}

}  // namespace skyquilt::merge
