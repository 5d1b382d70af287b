// Options of section [trust] of the configuration: how far renderings can be trusted, place by place.
#pragma once

#include <vector>

#include "core/config/options.h"
#include "core/image/pixel_cache.h"
#include "core/trust/left_out_tiles.h"

namespace skyquilt::trust {

struct TrustOptions {
  int tiles = 100;  // 0: nothing is left out of training, and trust is not measured
  double rays = 2e6;

  // Of these photos.
  LeftOutTiles LeftOut(const image::PixelCache& pixels) const;
  bool Measured() const { return tiles > 0; }

  static std::vector<config::Field<TrustOptions>> Fields();
  // Throws base::UsageError for values that are not allowed.
  void Check() const;
};

}  // namespace skyquilt::trust
