#include "tour/pictures/jpeg_quality.h"

namespace skyquilt::tour {

JpegFit FitQuality(const std::function<int64_t(int quality)>& bytes_at, int64_t limit_bytes) {
  // The best first: most tours fit with it.
  const int64_t most = bytes_at(kMostQuality);
  if (most <= limit_bytes) return {kMostQuality, most, true};
  const int64_t least = bytes_at(kLeastQuality);
  JpegFit fit{kLeastQuality, least, least <= limit_bytes};
  int above = kMostQuality;  // does not fit
  while (fit.fits && above - fit.quality > 1) {
    const int middle = (fit.quality + above) / 2;
    const int64_t bytes = bytes_at(middle);
    if (bytes <= limit_bytes) {
      fit = {middle, bytes, true};
    } else {
      above = middle;
    }
  }
  return fit;
}

}  // namespace skyquilt::tour
