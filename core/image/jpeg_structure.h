// Reads the marker structure of a JPEG (ITU-T T.81 annex B) without decoding it: its size, and whether it is all there.
// Decoders paint missing rows grey and only warn; a survey photo must not be trained on grey.
#pragma once

#include <cstdint>
#include <span>

namespace skyquilt::image {

struct JpegStructure {
  bool is_jpeg = false;  // starts with the SOI marker
  int width = 0;         // 0 until a frame header was met
  int height = 0;
  bool complete = false;  // the end marker of the first image follows its scans; what comes after it (previews, maker data) is not looked at
};

// Any bytes are legal, also none. With headers_only the walk ends at the frame header and `complete` stays false.
JpegStructure ParseJpeg(std::span<const uint8_t> bytes, bool headers_only);

}  // namespace skyquilt::image
