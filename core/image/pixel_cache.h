// Decoded photos at one training width in one memory-mapped file, built once, streaming one photo at a time:
// memory stays bounded whatever the number of photos. Rebuilt when a source's size or time, or the width, changed.
// Written under a temporary name and renamed, so that an interrupted build is never used.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/memory_map.h"
#include "core/base/thread_pool.h"

namespace skyquilt::image {

struct PixelSource {
  std::filesystem::path photo;
  std::filesystem::path mask;  // empty: every pixel counts
};

class PixelCache {
 public:
  struct Entry {
    int width = 0;
    int height = 0;
    size_t rgb_offset = 0;
    size_t mask_offset = 0;  // 0: no mask
  };

  // Opens `file`, building it first when needed, with a progress bar. image_width <= 0 or above a photo's own width keeps that photo's size.
  // Throws base::InputError for unreadable photos (naming all of them) and for a full disk (removing the partial file).
  static PixelCache Open(const std::filesystem::path& file, const std::vector<PixelSource>& sources, int image_width, base::ThreadPool& threads);

  size_t size() const { return entries_.size(); }
  int Width(size_t photo) const { return entries_[photo].width; }
  int Height(size_t photo) const { return entries_[photo].height; }
  size_t FileBytes() const { return map_.bytes().size(); }
  // One pixel (row-major index), as three display values; false where it is to be ignored. For random access: see Stream.
  bool Pixel(size_t photo, size_t pixel, uint8_t rgb[3]) const;
  // Reads single pixels from the file instead of through mapped pages, so that their number costs no memory.
  void Stream(bool on) { streaming_ = on; }
  bool streaming() const { return streaming_; }
  // A whole photo as a copy, which never stays mapped: row-major RGB, and its mask (empty when it has none).
  struct Photo {
    std::vector<uint8_t> rgb, mask;
  };
  Photo Copy(size_t photo) const;
  // Row-major RGB, width * height * 3 bytes, sRGB display values.
  std::span<const uint8_t> Rgb(size_t photo) const;
  // Row-major, width * height bytes, 0 = ignore; empty when the photo has no mask.
  std::span<const uint8_t> Mask(size_t photo) const;

 private:
  base::MemoryMap map_;
  std::vector<Entry> entries_;
  bool streaming_ = false;
};

}  // namespace skyquilt::image
