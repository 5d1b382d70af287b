// Images in memory, and reading, writing and resizing them. Row-major, channels interleaved, row 0 at the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::image {

template <typename T>
struct BasicImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<T> data;  // height * width * channels

  BasicImage() = default;
  BasicImage(int w, int h, int c, T value = T{})
      : width(w), height(h), channels(c), data(static_cast<size_t>(w) * static_cast<size_t>(h) * static_cast<size_t>(c), value) {}
  T* At(int x, int y) {
    return data.data() + (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * static_cast<size_t>(channels);
  }
  const T* At(int x, int y) const {
    return data.data() + (static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)) * static_cast<size_t>(channels);
  }
  bool Empty() const { return data.empty(); }
};
using Image8 = BasicImage<uint8_t>;
using ImageF = BasicImage<float>;

// Loads a photo as 8-bit RGB. Grey becomes three equal channels, 16 bits are scaled to 8, alpha is dropped (see LoadAlphaMask). EXIF
// rotation is NOT applied, because camera models refer to stored pixels. A truncated JPEG is an error: decoders would fill the missing rows with
// grey. Throws base::InputError.
Image8 LoadRgb8(const std::filesystem::path& file);
// The same, but a JPEG is decoded at a half, a quarter or an eighth of its size when that still has `width` pixels across: up to ten times faster.
Image8 LoadReducedRgb8(const std::filesystem::path& file, int width);
// As LoadRgb8 for the bytes of an image file.
Image8 DecodeRgb8(std::span<const uint8_t> bytes);
// Width and height; JPEG, PNG and TIFFs that are not plain (pixel_format.h) are not decoded for it. Throws base::InputError.
void ReadImageSize(const std::filesystem::path& file, int* width, int* height);
// Loads a mask as one channel, 0 = ignore and 255 = use. A pixel is used when any of its colour channels is not 0 (alpha does not count).
// Throws base::InputError.
Image8 LoadMask(const std::filesystem::path& file);
// The alpha of a photo as a mask: 255 where it is at least half opaque, else 0. Empty when it has no alpha or is opaque everywhere. Throws
// base::InputError.
Image8 LoadAlphaMask(const std::filesystem::path& file);
// One channel of 8 bits as stored, for images of class numbers. Throws base::InputError for other pixel types and unreadable files.
Image8 LoadLabels(const std::filesystem::path& file);
// Float TIFF with one channel, for depth images. NaN and infinity are kept bit by bit.
// Throws base::InputError for other pixel types and unreadable files.
ImageF LoadFloatTiff(const std::filesystem::path& file);
void SaveFloatTiff(const ImageF& image, const std::filesystem::path& file);

// All Save functions write atomically and throw base::InputError (disk full, no permission). quality: 0 to 100.
void SavePng(const Image8& image, const std::filesystem::path& file);  // 1 or 3 channels
void SaveJpeg(const Image8& image, const std::filesystem::path& file, int quality);

// As file bytes in memory, for those who send images instead of writing files.
std::vector<uint8_t> EncodeJpeg(const Image8& image, int quality);
// The fastest compression that still halves pictures: one filter and runs of equal bytes.
constexpr int kFastPng = 0;
// Grey, RGB or RGBA (alpha not premultiplied). level: kFastPng, or 1 to 9 (smallest and slowest). Throws std::logic_error for an empty image or
// another number of channels.
std::string EncodePng(const Image8& image, int level);

// Reduces by averaging areas (of sRGB values, as other image programs do); enlarges bilinearly.
Image8 Resize(const Image8& image, int width, int height);
// Resizes a mask: a pixel is used (255) only if all source pixels that it overlaps are used.
Image8 ResizeMask(const Image8& mask, int width, int height);
// The height for `new_width` that keeps the aspect ratio, at least 1.
int ScaledHeight(int width, int height, int new_width);
// Float values in [0, 1] (clamped, NaN becomes 0) to 8 bits and back.
Image8 ToImage8(const ImageF& image);
ImageF ToImageF(const Image8& image);
// Shows one channel in the viridis colour map, values clamped to [low, high]; non-finite values become black.
Image8 Colorize(const ImageF& image, float low, float high);

}  // namespace skyquilt::image
