// HEIC and DNG files for tests, made by hand and by libheif.
#pragma once

#include <libheif/heif.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace skyquilt::test {

// A DNG of a sensor with the primaries of sRGB: the values, row by row, of red, green, green and blue cells in turn; white is `white`.
inline std::string MadeDng(int width, int height, const std::vector<uint16_t>& values, uint32_t white, int orientation = 1) {
  struct Entry {
    uint16_t tag = 0, type = 0;
    uint32_t count = 0;
    std::string data;
  };
  const auto number = [](uint32_t value, int size) {
    std::string bytes;
    for (int i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * i) & 255U);
    return bytes;
  };
  const auto rationals = [&number](const std::vector<double>& all) {
    std::string bytes;
    for (const double value : all) bytes += number(static_cast<uint32_t>(static_cast<int32_t>(std::lround(value * 10000.0))), 4) + number(10000, 4);
    return bytes;
  };
  constexpr uint16_t kByte = 1, kText = 2, kShort = 3, kLong = 4, kRational = 5, kSignedRational = 10;
  const std::string model = std::string("Made") + '\0';
  const auto size_of = [](int value) { return static_cast<uint32_t>(value); };
  std::vector<Entry> entries = {
      {254, kLong, 1, number(0, 4)},
      {256, kLong, 1, number(size_of(width), 4)},
      {257, kLong, 1, number(size_of(height), 4)},
      {258, kShort, 1, number(16, 2)},
      {259, kShort, 1, number(1, 2)},
      {262, kShort, 1, number(32803, 2)},
      {271, kText, 5, model},
      {272, kText, 5, model},
      {273, kLong, 1, number(0, 4)},  // set below
      {274, kShort, 1, number(size_of(orientation), 2)},
      {277, kShort, 1, number(1, 2)},
      {278, kLong, 1, number(size_of(height), 4)},
      {279, kLong, 1, number(size_of(2 * width * height), 4)},
      {284, kShort, 1, number(1, 2)},
      {33421, kShort, 2, number(2, 2) + number(2, 2)},
      {33422, kByte, 4, std::string{0, 1, 1, 2}},
      {50706, kByte, 4, std::string{1, 4, 0, 0}},
      {50708, kText, 5, model},
      {50714, kShort, 1, number(0, 2)},
      {50717, kLong, 1, number(white, 4)},
      // From XYZ to sRGB.
      {50721, kSignedRational, 9, rationals({3.2406, -1.5372, -0.4986, -0.9689, 1.8758, 0.0415, 0.0557, -0.2040, 1.0570})},
      {50728, kRational, 3, rationals({1.0, 1.0, 1.0})},
      {50778, kShort, 1, number(21, 2)},
  };
  const size_t directory = 2 + 12 * entries.size() + 4;
  std::string far;
  const auto place = [&](size_t offset) { return number(static_cast<uint32_t>(8 + directory + offset), 4); };
  size_t far_size = 0;
  for (const Entry& entry : entries) far_size += entry.data.size() > 4 ? entry.data.size() + entry.data.size() % 2 : 0;
  std::string bytes = std::string("II*\0", 4) + number(8, 4) + number(static_cast<uint32_t>(entries.size()), 2);
  for (Entry& entry : entries) {
    if (entry.tag == 273) entry.data = place(far_size);
    bytes += number(entry.tag, 2) + number(entry.type, 2) + number(entry.count, 4);
    if (entry.data.size() > 4) {
      bytes += place(far.size());
      far += entry.data;
      if (far.size() % 2 != 0) far += '\0';
    } else {
      bytes += entry.data + std::string(4 - entry.data.size(), '\0');
    }
  }
  bytes += number(0, 4) + far;
  for (const uint16_t value : values) bytes += number(value, 2);
  return bytes;
}

// False when this libheif cannot write HEIC. exif: of the photo, from its TIFF header on; empty: none.
inline bool WriteHeic(const image::Image8& pixels, const std::filesystem::path& file, const std::string& exif = "") {
  heif_context* context = heif_context_alloc();
  heif_encoder* encoder = nullptr;
  bool written = heif_context_get_encoder_for_format(context, heif_compression_HEVC, &encoder).code == heif_error_Ok;
  if (written) {
    heif_encoder_set_lossy_quality(encoder, 95);
    heif_image* picture = nullptr;
    heif_image_create(pixels.width, pixels.height, heif_colorspace_RGB, heif_chroma_interleaved_RGB, &picture);
    heif_image_add_plane(picture, heif_channel_interleaved, pixels.width, pixels.height, 8);
    int stride = 0;
    uint8_t* rows = heif_image_get_plane(picture, heif_channel_interleaved, &stride);
    for (int y = 0; y < pixels.height; ++y)
      std::memcpy(rows + static_cast<ptrdiff_t>(stride) * y, pixels.At(0, y), static_cast<size_t>(3) * pixels.width);
    heif_image_handle* handle = nullptr;
    written = heif_context_encode_image(context, picture, encoder, nullptr, &handle).code == heif_error_Ok;
    if (written && !exif.empty()) heif_context_add_exif_metadata(context, handle, exif.data(), static_cast<int>(exif.size()));
    written = written && heif_context_write_to_file(context, file.c_str()).code == heif_error_Ok;
    heif_image_handle_release(handle);
    heif_image_release(picture);
    heif_encoder_release(encoder);
  }
  heif_context_free(context);
  return written;
}

}  // namespace skyquilt::test
