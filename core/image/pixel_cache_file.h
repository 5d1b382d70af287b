// Reads and writes the file of PixelCache. Layout, little-endian, byte offsets first:
//   0  magic "SKQPIXEL"   8  uint32 version   12  uint32 zero   16  uint64 index offset   24  uint64 index length   32  index hash, 16 hex digits
//   64 photos in order: RGB bytes, then mask bytes where there is a mask; then the index, JSON:
//      {"key": {image width, sources with size and time}, "entries": [[width, height, rgb offset, mask offset], ...]}
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/errors.h"
#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"

namespace skyquilt::image {

struct PixelCacheIndex {
  std::string key;  // PixelCacheKey of the sources it was built from
  std::vector<PixelCache::Entry> entries;
};

// Everything the cache depends on (width, paths, sizes and times of the sources) as JSON text; the cache is valid while this does not change.
// Throws base::InputError that lists every missing photo or mask.
std::string PixelCacheKey(const std::vector<PixelSource>& sources, int image_width);

// The index of a mapped cache file; nothing if the bytes are not a complete cache of this version.
std::optional<PixelCacheIndex> ReadPixelCacheIndex(std::span<const uint8_t> bytes);

// The index as JSON text, and the header that points to it.
std::string PixelCacheIndexText(const PixelCacheIndex& index);
std::string PixelCacheHeader(const std::string& index_text, size_t index_offset);
inline constexpr size_t kPixelCacheHeaderBytes = 64;

// Decodes, resizes and writes all photos, unless another process has built the same file while this one waited for the lock.
void BuildPixelCache(const std::filesystem::path& file, const std::string& key, const std::vector<PixelSource>& sources, int image_width,
                     base::ThreadPool& threads);

// Throws one error with the text of all of them; does nothing for an empty list.
void ThrowPhotoErrors(const std::vector<base::InputError>& errors, size_t n_photos);

}  // namespace skyquilt::image
