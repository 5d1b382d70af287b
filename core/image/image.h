// Images in memory: row-major, channels interleaved, row 0 at the top.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
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

// RGB, 8 bits. Grey becomes three equal channels, 16 bits are scaled to 8, alpha is dropped (the first such file of a process is
// named in a warning); EXIF rotation is NOT applied (the camera model refers to stored pixels). A JPEG that ends early is refused, not
// half-decoded.
// Throws base::InputError naming file, finding and how to fix it.
Image8 LoadRgb8(const std::filesystem::path& file);
// Width and height from the header alone. Throws base::InputError.
void ReadImageSize(const std::filesystem::path& file, int* width, int* height);
// One channel of 0 = ignore and 255 = use; a pixel is used when any of its colour channels is not 0 (alpha does not count).
Image8 LoadMask(const std::filesystem::path& file);
// Float TIFF, one channel (true depth of simulated surveys, rendered depth). NaN and infinities survive bit by bit.
// Throws base::InputError for other pixel types and unreadable files.
ImageF LoadFloatTiff(const std::filesystem::path& file);
void SaveFloatTiff(const ImageF& image, const std::filesystem::path& file);

// All Save functions write atomically and throw base::InputError (disk full, no permission). quality: 0 to 100.
void SavePng(const Image8& image, const std::filesystem::path& file);  // 1 or 3 channels
std::vector<uint8_t> EncodeJpeg(const Image8& image, int quality);
void SaveJpeg(const Image8& image, const std::filesystem::path& file, int quality);

// Area-averaging resize (in display values, like the photos' own reduced copies would be); bilinear where it enlarges.
Image8 Resize(const Image8& image, int width, int height);
// Mask resize: a reduced pixel is usable (255) only if every source pixel under it, even in part, is.
Image8 ResizeMask(const Image8& mask, int width, int height);
// Height that keeps the aspect ratio at `new_width`, at least 1.
int ScaledHeight(int width, int height, int new_width);
// Float RGB in [0,1] (clamped, NaN becomes 0) to 8 bits and back.
Image8 ToImage8(const ImageF& image);
ImageF ToImageF(const Image8& image);
// One-channel values to a perceptual colour map (viridis) between low and high, clamped; non-finite becomes black.
Image8 Colorize(const ImageF& image, float low, float high);

}  // namespace skyquilt::image
