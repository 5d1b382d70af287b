#include "merge/merge_options.h"

#include "core/base/errors.h"

namespace skyquilt::merge {

void MergeOptions::Visit(config::OptionVisitor& v) {
  v.Field("storage", storage,
          "how the hash tables are kept in the scene: fp32 as they were trained, bf16 or fp16 in half the bytes (what is too large becomes the "
          "largest number)");
  v.Field("borders", borders,
          "smooth: neighbouring blocks are blended across their margins; hard: every block ends at its face and the next one begins there");
}

void MergeOptions::Check() const {
  if (storage != "fp32" && storage != "bf16" && storage != "fp16") {
    throw base::UsageError("merge.storage = " + storage + " cannot be: it must be fp32, bf16 or fp16");
  }
  if (borders != "smooth" && borders != "hard") throw base::UsageError("merge.borders = " + borders + " cannot be: it must be smooth or hard");
}

checkpoint::Precision MergeOptions::Storage() const {
  if (storage == "bf16") return checkpoint::Precision::kBfloat16;
  return storage == "fp16" ? checkpoint::Precision::kFloat16 : checkpoint::Precision::kFloat32;
}

}  // namespace skyquilt::merge
