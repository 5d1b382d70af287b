// Finds truncated JPEGs, and the image size, from the markers (ITU-T T.81 annex B) without decoding the image. Decoders fill missing rows with grey
// and only warn; training must not use such rows.
#pragma once

#include <cstdint>
#include <span>

namespace skyquilt::image {

struct JpegStructure {
  bool is_jpeg = false;  // starts with the SOI marker
  int width = 0;         // 0 if there is no frame header
  int height = 0;
  int bits = 0;              // per number, of the frame header
  int components = 0;        // 1: grey, 3: colours, 4: CMYK
  uint8_t frame_marker = 0;  // of the frame header: 0xC0 to 0xC2 are the kinds that all programs read; 0 if there is none
  bool complete = false;     // the first image has a scan and an end marker; data after it (previews, maker data) is not read
};

// Accepts any bytes, even none. With headers_only it stops at the frame header and `complete` stays false.
JpegStructure ParseJpeg(std::span<const uint8_t> bytes, bool headers_only);

}  // namespace skyquilt::image
