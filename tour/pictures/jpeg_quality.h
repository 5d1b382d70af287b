// The JPEG quality with which pictures keep to a limit of bytes.
#pragma once

#include <cstdint>
#include <functional>

namespace skyquilt::tour {

// Below, blocks of 8 pixels show; above, files grow much and nobody sees a difference.
constexpr int kLeastQuality = 60, kMostQuality = 92;

struct JpegFit {
  int quality = kLeastQuality;
  int64_t bytes = 0;  // with this quality
  bool fits = false;  // false: not even the least quality keeps to the limit, so make the pictures smaller
};

// Finds by bisection the highest quality from kLeastQuality to kMostQuality whose bytes are at most the limit. Bytes are taken to grow with quality;
// where they do not quite, the result still keeps to the limit.
JpegFit FitQuality(const std::function<int64_t(int quality)>& bytes_at, int64_t limit_bytes);

}  // namespace skyquilt::tour
