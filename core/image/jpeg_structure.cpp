#include "core/image/jpeg_structure.h"

#include <cstddef>

namespace skyquilt::image {
namespace {

constexpr uint8_t kStartOfImage = 0xD8;
constexpr uint8_t kEndOfImage = 0xD9;
constexpr uint8_t kStartOfScan = 0xDA;

bool IsFrameHeader(uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}
// Restart markers and TEM carry no length.
bool StandsAlone(uint8_t marker) {
  return (marker >= 0xD0 && marker <= 0xD7) || marker == 0x01;
}

// Position of the first marker at or after `at` that ends the compressed data (not a stuffed byte or a restart marker); size() if there is none.
size_t EndOfEntropyData(std::span<const uint8_t> bytes, size_t at) {
  while (at + 1 < bytes.size()) {
    if (bytes[at] == 0xFF && bytes[at + 1] != 0x00 && bytes[at + 1] != 0xFF && !StandsAlone(bytes[at + 1])) return at;
    ++at;
  }
  return bytes.size();
}

}  // namespace

JpegStructure ParseJpeg(std::span<const uint8_t> bytes, bool headers_only) {
  JpegStructure found;
  if (bytes.size() < 3 || bytes[0] != 0xFF || bytes[1] != kStartOfImage || bytes[2] != 0xFF) return found;
  found.is_jpeg = true;
  bool had_scan = false;
  size_t at = 2;
  while (at + 1 < bytes.size()) {
    if (bytes[at] != 0xFF || bytes[at + 1] == 0xFF || bytes[at + 1] == 0x00) {
      ++at;  // fill bytes, or invalid bytes between segments, which decoders skip too
      continue;
    }
    const uint8_t marker = bytes[at + 1];
    at += 2;
    if (marker == kEndOfImage) {
      found.complete = had_scan;
      return found;
    }
    if (StandsAlone(marker) || marker == kStartOfImage) continue;
    if (at + 2 > bytes.size()) return found;
    const size_t length = static_cast<size_t>(bytes[at]) << 8U | bytes[at + 1];
    if (length < 2 || at + length > bytes.size()) return found;
    if (IsFrameHeader(marker) && length >= 8) {
      found.frame_marker = marker;
      found.bits = bytes[at + 2];
      found.components = bytes[at + 7];
      found.height = bytes[at + 3] << 8 | bytes[at + 4];
      found.width = bytes[at + 5] << 8 | bytes[at + 6];
      if (headers_only) return found;
    }
    at += length;
    if (marker == kStartOfScan) {
      had_scan = true;
      at = EndOfEntropyData(bytes, at);
    }
  }
  return found;
}

}  // namespace skyquilt::image
