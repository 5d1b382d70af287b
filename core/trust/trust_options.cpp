#include "core/trust/trust_options.h"

#include <algorithm>

namespace skyquilt::trust {
namespace {

constexpr double kMostShare = 0.02;

}  // namespace

LeftOutTiles TrustOptions::LeftOut(const image::PixelCache& pixels) const {
  double all = 0.0;
  for (size_t photo = 0; photo < pixels.size(); ++photo) {
    all += static_cast<double>(pixels.Width(photo) / LeftOutTiles::kSide) * static_cast<double>(pixels.Height(photo) / LeftOutTiles::kSide);
  }
  return {std::min(kMostShare, tiles / std::max(all, 1.0))};
}

std::vector<config::Field<TrustOptions>> TrustOptions::Fields() {
  using config::Range;
  using O = TrustOptions;
  return {
      {"tiles", &O::tiles, Range{0, 1e6},
       "about so many tiles of 16 x 16 pixels of the photos, at most 2 % of all, are not learned from, so that the errors to expect are known; 0: "
       "all "
       "are learned from, and trust is not measured"},
      {"rays", &O::rays, Range{1e3, 1e10}, "pixels of training photos at most that the finished scene is compared with"},
  };
}

void TrustOptions::Check() const {
  config::CheckRanges("trust", *this);
}

}  // namespace skyquilt::trust
