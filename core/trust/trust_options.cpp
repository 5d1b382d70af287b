#include "core/trust/trust_options.h"

namespace skyquilt::trust {

std::vector<config::Field<TrustOptions>> TrustOptions::Fields() {
  using config::Range;
  using O = TrustOptions;
  return {
      {"tiles", &O::tiles, Range{0.0, 0.5},
       "share of all tiles of 16 x 16 pixels of the training photos that nothing is learned from, so that the errors to expect are known; 0: all are "
       "learned from, and trust is not measured"},
      {"rays", &O::rays, Range{1e3, 1e10}, "pixels of training photos at most that the finished scene is compared with"},
  };
}

void TrustOptions::Check() const {
  config::CheckRanges("trust", *this);
}

}  // namespace skyquilt::trust
