#include "coordinator/merge/merge_options.h"

#include "core/base/errors.h"

namespace skyquilt::coordinator {

void MergeOptions::Visit(config::OptionVisitor& v) {
  v.Field("borders", borders,
          "smooth: neighbouring blocks are blended across their margins; hard: every block ends at its face and the next one begins there");
}

void MergeOptions::Check() const {
  if (borders != "smooth" && borders != "hard") throw base::UsageError("merge.borders = " + borders + " cannot be: it must be smooth or hard");
}

}  // namespace skyquilt::coordinator
