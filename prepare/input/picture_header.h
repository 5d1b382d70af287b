// What the header of a picture says of it, without decoding.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace skyquilt::prepare::input {

enum class PictureFormat { kUnknown, kJpeg, kPng, kTiff };

struct PictureHeader {
  PictureFormat format = PictureFormat::kUnknown;
  int width = 0;  // pixels, as stored; 0: not known
  int height = 0;
  int channels = 0;        // per pixel, alpha among them, a palette's colours counted as 3; 0: not known
  bool has_alpha = false;  // a channel or palette that says so: a fourth channel alone may be near infrared
  bool is_map = false;     // TIFF with a geo-reference (GeoTIFF)
};

// Accepts any bytes: what they do not say stays unknown. JPEG, PNG, and TIFF of less than 4 GiB (its first picture).
PictureHeader ParsePictureHeader(std::span<const uint8_t> bytes);
// Unknown for a file that cannot be read.
PictureHeader ReadPictureHeader(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::input
