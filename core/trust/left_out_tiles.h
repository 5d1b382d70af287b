// Small squares of training photos that no field learns from, so that the errors of a scene can be measured where it was not trained. Unlike held-out
// photos they are spread over all photos, so that scores of held-out photos can check what is predicted from them.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/random.h"

namespace skyquilt::trust {

struct LeftOutTiles {
  static constexpr int kSide = 16;  // pixels of the cached photos

  double share = 0.0;  // of all tiles, 0 to 0.5; 0: none

  bool Any() const { return share > 0.0; }
  // Whether the tile of this pixel is left out. Tiles are chosen by a hash of the photo's number and the tile's place. A pixel outside the photo
  // belongs to the tile it would be in.
  bool At(size_t photo, int x, int y) const {
    if (!Any()) return false;
    const uint64_t place = (static_cast<uint64_t>(static_cast<uint32_t>(x / kSide)) << 32U) | static_cast<uint32_t>(y / kSide);
    const uint64_t hash = base::MixBits(base::MixBits(static_cast<uint64_t>(photo)) ^ place);
    return static_cast<double>(hash >> 11U) * 0x1p-53 < share;
  }
  // Whether a square of pixels touches a tile that is left out.
  bool Touch(size_t photo, int x, int y, int size) const {
    if (!Any()) return false;
    for (int v = y; v < y + size + kSide - 1; v += kSide) {
      for (int u = x; u < x + size + kSide - 1; u += kSide) {
        if (At(photo, u < x + size ? u : x + size - 1, v < y + size ? v : y + size - 1)) return true;
      }
    }
    return false;
  }
};

}  // namespace skyquilt::trust
