// What the pixels of a photo are, by the header of its file: JPEG, PNG and TIFF (also BigTIFF); nothing is decoded.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

namespace skyquilt::image {

enum class FileKind { kOther, kJpeg, kPng, kTiff };

struct PixelFormat {
  FileKind kind = FileKind::kOther;
  int width = 0;  // 0 where the header does not say
  int height = 0;
  int bands = 0;  // numbers per pixel, with alpha; the indices of a palette are one. 0: not known
  int bits = 0;   // of a number, the most of all bands; 0: not known
  bool floating = false;
  bool has_palette = false;
  bool is_rgb = false;   // the first three bands are red, green and blue (or become so by decoding)
  bool is_cmyk = false;  // of a TIFF, which is not converted by decoders
  int alpha_bands = 0;   // at the end; TIFF says so in ExtraSamples
  // The value of white by the tags: DNG's WhiteLevel, else TIFF's SMaxSampleValue or MaxSampleValue. Programs write the largest value of the type
  // there without knowing; such values are left out.
  std::optional<double> white;
};

// Of a file that is none of these, or whose header is damaged: as much as is known. Throws base::InputError when it cannot be read.
PixelFormat ReadPixelFormat(const std::filesystem::path& file);
// The same for the bytes of a file.
PixelFormat PixelFormatOf(std::span<const uint8_t> bytes);

// Whether all parts of the program and COLMAP read the photo as it is: at most 8 bits, and grey, a palette, RGB or RGBA. Also true for what is not
// known, since decoding will tell.
bool IsPlain(const PixelFormat& format);

}  // namespace skyquilt::image
