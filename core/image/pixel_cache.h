// Keeps all decoded photos, resized to the training width, in one memory-mapped file: decoding them again for every run would be slow, and they need
// not fit in memory. Built a few photos at a time and only once; rebuilt when the size or time of a source file, or the width, has changed.
// Written under a temporary name and renamed when complete, so that an interrupted build is never used.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/memory_map.h"
#include "core/base/thread_pool.h"

namespace skyquilt::image {

struct PixelSource {
  std::filesystem::path photo;
  std::filesystem::path mask;  // empty: every pixel is used
};

class PixelCache {
 public:
  // Size of a photo in the cache, and where its pixels are in the file.
  struct Entry {
    int width = 0;
    int height = 0;
    size_t rgb_offset = 0;
    size_t mask_offset = 0;  // 0: no mask
  };

  // Opens `file`; builds it first when needed, with a progress bar. image_width <= 0 or above a photo's width keeps the photo's size.
  // Throws base::InputError for unreadable photos (lists all of them) and for a full disk (the partial file is removed).
  static PixelCache Open(const std::filesystem::path& file, const std::vector<PixelSource>& sources, int image_width, base::ThreadPool& threads);

  // Opens a file that Open has made, perhaps on another machine that sees other times of the photos, which are not looked at. identity: of that
  // cache. Throws base::InputError when the file is another one.
  static PixelCache OpenBuilt(const std::filesystem::path& file, const std::string& identity);

  // Changes whenever Open would build the cache anew.
  const std::string& identity() const { return identity_; }
  size_t size() const { return entries_.size(); }
  int Width(size_t photo) const { return entries_[photo].width; }
  int Height(size_t photo) const { return entries_[photo].height; }
  size_t FileBytes() const { return map_.bytes().size(); }
  // The sRGB values of one pixel (row-major index); false where the mask says to ignore it. For random access, see Stream.
  bool Pixel(size_t photo, size_t pixel, uint8_t rgb[3]) const;
  // Mean of the size x size pixels whose first is (x, y), in linear light, without masked ones; false when fewer than half of them are left. They
  // must be inside the photo.
  bool MeanLight(size_t photo, int x, int y, int size, float light[3]) const;
  // When on, Pixel reads from the file instead of through mapped pages: slower, but the photos take no memory.
  void Stream(bool on) { streaming_ = on; }
  bool streaming() const { return streaming_; }
  // A copy of a whole photo, read from the file: row-major RGB, and its mask (empty when it has none).
  struct Photo {
    std::vector<uint8_t> rgb, mask;
  };
  Photo Copy(size_t photo) const;
  // Row-major RGB, width * height * 3 bytes, sRGB values; valid as long as the cache.
  std::span<const uint8_t> Rgb(size_t photo) const;
  // Row-major, width * height bytes, 0 = ignore; empty when the photo has no mask.
  std::span<const uint8_t> Mask(size_t photo) const;

 private:
  static std::optional<PixelCache> IfBuilt(const std::filesystem::path& file, const std::string& identity);

  base::MemoryMap map_;
  std::vector<Entry> entries_;
  std::string identity_;
  bool streaming_ = false;
};

}  // namespace skyquilt::image
