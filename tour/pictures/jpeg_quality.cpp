#include "tour/pictures/jpeg_quality.h"

#include <numeric>
#include <set>
#include <vector>

#include "core/base/cancel.h"
#include "core/image/image.h"
#include "tour/pictures/picture_file.h"

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

JpegFit FitPictures(std::span<const std::filesystem::path> files, int64_t limit_bytes, base::ThreadPool& threads) {
  const std::set<std::filesystem::path> once(files.begin(), files.end());
  const std::vector<std::filesystem::path> pictures(once.begin(), once.end());
  const auto bytes_at = [&](int quality) {
    std::vector<int64_t> bytes(pictures.size());
    threads.ParallelFor(static_cast<int64_t>(pictures.size()), [&](int64_t i, int) {
      base::ThrowIfCancelled();
      const auto index = static_cast<size_t>(i);
      bytes[index] = static_cast<int64_t>(image::EncodeJpeg(ColorsOf(OpenPicture(pictures[index])), quality).size());
    });
    return std::accumulate(bytes.begin(), bytes.end(), int64_t{0});
  };
  return FitQuality(bytes_at, limit_bytes);
}

}  // namespace skyquilt::tour
