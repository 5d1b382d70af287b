// Image files written byte by byte, independently of the code under test.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace skyquilt {

void WriteBytes(const std::filesystem::path& file, const std::string& bytes);

struct RawPng {
  int width = 0;
  int height = 0;
  int bit_depth = 8;            // 8 or 16
  int colour_type = 2;          // 0 grey, 2 RGB, 4 grey and alpha, 6 RGBA
  std::vector<uint8_t> pixels;  // row-major, big-endian samples
};
// PNG with stored (uncompressed) data.
std::string PngBytes(const RawPng& png);

// A colourful image without symmetry: channel c of pixel (x, y) differs from its neighbours.
image::Image8 Pattern(int width, int height);

}  // namespace skyquilt
