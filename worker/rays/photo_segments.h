// Parts of photos that probably show one plane: segments of similar colour (Felzenszwalb and Huttenlocher 2004) without vegetation and strong
// texture. Computed from the photos as they are cached, reduced to kSegmentWidth pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "core/image/pixel_cache.h"

namespace skyquilt::worker {

constexpr int kSegmentWidth = 320;

// Label per pixel of an RGB photo, 0: none; the borders of segments belong to none.
image::BasicImage<uint16_t> SegmentPhoto(const image::Image8& rgb);

class PhotoSegments {
 public:
  // Of these photos only; the others have no segments. Two bytes of memory per pixel of the reduced photos.
  PhotoSegments(const image::PixelCache& pixels, const std::vector<int>& photos, base::ThreadPool& threads);

  // The segment of a pixel of the cached photo; 0: none.
  uint16_t At(int photo, int x, int y) const;

 private:
  struct Labels {
    image::BasicImage<uint16_t> image;
    double per_pixel_x = 0.0, per_pixel_y = 0.0;  // reduced pixels per cached pixel
  };
  std::vector<Labels> labels_;  // per photo of the cache
};

}  // namespace skyquilt::worker
