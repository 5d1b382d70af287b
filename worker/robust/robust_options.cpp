#include "worker/robust/robust_options.h"

namespace skyquilt::worker {

std::vector<config::Field<RobustOptions>> RobustOptions::Fields() {
  using config::Range;
  using O = RobustOptions;
  return {
      {"movers", &O::movers, Range::OneOf({"off", "on", "auto"}),
       "on: blocks do not learn from pixels that show what moved between photos: where at least three others that see the same place agree on "
       "another "
       "colour; at most 3 % of a photo. auto: only where photos otherwise agree, so not on waves or in photos whose light changes. off: all pixels "
       "count"},
      {"prefer", &O::prefer, Range::OneOf({"any", "latest"}),
       "latest: where flights of a survey show different things, blocks do not learn from the earlier ones; any: all flights count alike"},
  };
}

void RobustOptions::Check() const {
  config::CheckRanges("robust", *this);
}

}  // namespace skyquilt::worker
