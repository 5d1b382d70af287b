#include "core/image/pixel_cache.h"

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/image/pixel_cache_file.h"
#include "core/image/srgb.h"

namespace skyquilt::image {
namespace {

constexpr char kMagic[] = "SKQPIXEL";
constexpr uint32_t kVersion = 1;

nlohmann::json Stamp(const std::filesystem::path& path) {
  return {std::filesystem::absolute(path).lexically_normal().string(), std::filesystem::file_size(path),
          static_cast<int64_t>(std::filesystem::last_write_time(path).time_since_epoch().count())};
}

std::string Dump(const nlohmann::json& json) {
  return base::JsonText(json);
}

template <typename T>
T Load(std::span<const uint8_t> bytes, size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

// True if width x height x channels bytes at `offset` end before `end`.
bool Fits(const PixelCache::Entry& entry, size_t offset, size_t channels, size_t end) {
  const size_t bytes = static_cast<size_t>(entry.width) * static_cast<size_t>(entry.height) * channels;
  return offset >= kPixelCacheHeaderBytes && offset <= end && bytes <= end - offset;
}

}  // namespace

void ThrowPhotoErrors(const std::vector<base::InputError>& errors, size_t n_photos) {
  if (errors.empty()) return;
  if (errors.size() == 1) throw base::InputError(errors.front());
  std::string all = std::to_string(errors.size()) + " of " + std::to_string(n_photos) + " photos cannot be used:";
  for (const base::InputError& error : errors) all += std::string("\n  ") + error.what();
  throw base::InputError(errors.front().file().parent_path(), all, "");
}

std::string PixelCacheKey(const std::vector<PixelSource>& sources, int image_width) {
  nlohmann::json stamps = nlohmann::json::array();
  std::vector<base::InputError> errors;
  for (const PixelSource& source : sources) {
    SKYQUILT_CHECK(!source.photo.empty(), "a pixel source needs a photo");
    for (const std::filesystem::path& path : {source.photo, source.mask}) {
      if (path.empty()) {
        stamps.push_back(nullptr);
        continue;
      }
      try {
        stamps.push_back(Stamp(path));
      } catch (const std::filesystem::filesystem_error& error) {
        errors.emplace_back(path, "cannot be read (" + error.code().message() + ")", "Restore the file, or run 'skyquilt prepare' again without it");
      }
    }
  }
  ThrowPhotoErrors(errors, sources.size());
  return Dump({{"image_width", std::max(image_width, 0)}, {"sources", stamps}});
}

std::optional<PixelCacheIndex> ReadPixelCacheIndex(std::span<const uint8_t> bytes) {
  if (bytes.size() < kPixelCacheHeaderBytes || std::memcmp(bytes.data(), kMagic, 8) != 0) return std::nullopt;
  const auto index_offset = Load<uint64_t>(bytes, 16);
  const auto index_length = Load<uint64_t>(bytes, 24);
  if (Load<uint32_t>(bytes, 8) != kVersion || index_offset > bytes.size() || index_length != bytes.size() - index_offset) return std::nullopt;
  const std::string text(reinterpret_cast<const char*>(bytes.data()) + index_offset, index_length);
  if (base::HashHex(text) != std::string(reinterpret_cast<const char*>(bytes.data()) + 32, 16)) return std::nullopt;
  try {
    const nlohmann::json json = base::ParseJson(text);
    PixelCacheIndex index;
    index.key = json.at("key").get<std::string>();
    for (const nlohmann::json& row : json.at("entries")) {
      const PixelCache::Entry entry{row.at(0).get<int>(), row.at(1).get<int>(), row.at(2).get<size_t>(), row.at(3).get<size_t>()};
      if (entry.width <= 0 || entry.height <= 0 || !Fits(entry, entry.rgb_offset, 3, index_offset)) return std::nullopt;
      if (entry.mask_offset != 0 && !Fits(entry, entry.mask_offset, 1, index_offset)) return std::nullopt;
      index.entries.push_back(entry);
    }
    return index;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::string PixelCacheIndexText(const PixelCacheIndex& index) {
  nlohmann::json entries = nlohmann::json::array();
  for (const PixelCache::Entry& entry : index.entries) entries.push_back({entry.width, entry.height, entry.rgb_offset, entry.mask_offset});
  return Dump({{"key", index.key}, {"entries", entries}});
}

std::string PixelCacheHeader(const std::string& index_text, size_t index_offset) {
  std::string header(kPixelCacheHeaderBytes, '\0');
  const uint64_t offset = index_offset;
  const uint64_t length = index_text.size();
  std::memcpy(header.data(), kMagic, 8);
  std::memcpy(header.data() + 8, &kVersion, sizeof(kVersion));
  std::memcpy(header.data() + 16, &offset, sizeof(offset));
  std::memcpy(header.data() + 24, &length, sizeof(length));
  std::memcpy(header.data() + 32, base::HashHex(index_text).data(), 16);
  return header;
}

std::optional<PixelCache> PixelCache::IfBuilt(const std::filesystem::path& file, const std::string& identity) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  PixelCache cache;
  cache.map_ = base::MemoryMap(file);
  std::optional<PixelCacheIndex> index = ReadPixelCacheIndex(cache.map_.bytes());
  if (!index || base::HashHex(index->key) != identity) return std::nullopt;
  cache.entries_ = std::move(index->entries);
  cache.identity_ = identity;
  return cache;
}

PixelCache PixelCache::Open(const std::filesystem::path& file, const std::vector<PixelSource>& sources, int image_width, base::ThreadPool& threads) {
  const std::string key = PixelCacheKey(sources, image_width);
  for (int attempt = 0; attempt < 2; ++attempt) {
    std::optional<PixelCache> cache = IfBuilt(file, base::HashHex(key));
    if (cache && cache->size() == sources.size()) return *std::move(cache);
    if (attempt == 0) BuildPixelCache(file, key, sources, image_width, threads);
  }
  throw base::InputError(file, "changed while it was being opened", "Run only one command at a time on this project folder");
}

PixelCache PixelCache::OpenBuilt(const std::filesystem::path& file, const std::string& identity) {
  if (std::optional<PixelCache> cache = IfBuilt(file, identity)) return *std::move(cache);
  throw base::InputError(file, "is missing here, or is not the file that rank 0 sees", "All ranks must see the same project folder");
}

std::span<const uint8_t> PixelCache::Rgb(size_t photo) const {
  SKYQUILT_CHECK(photo < entries_.size(), "photo " + std::to_string(photo) + " of " + std::to_string(entries_.size()));
  const Entry& entry = entries_[photo];
  return map_.bytes().subspan(entry.rgb_offset, static_cast<size_t>(entry.width) * static_cast<size_t>(entry.height) * 3);
}

std::span<const uint8_t> PixelCache::Mask(size_t photo) const {
  SKYQUILT_CHECK(photo < entries_.size(), "photo " + std::to_string(photo) + " of " + std::to_string(entries_.size()));
  const Entry& entry = entries_[photo];
  if (entry.mask_offset == 0) return {};
  return map_.bytes().subspan(entry.mask_offset, static_cast<size_t>(entry.width) * static_cast<size_t>(entry.height));
}

PixelCache::Photo PixelCache::Copy(size_t photo) const {
  const Entry& entry = entries_[photo];
  const size_t n = static_cast<size_t>(entry.width) * static_cast<size_t>(entry.height);
  Photo copy;
  copy.rgb.resize(3 * n);
  map_.ReadAt(entry.rgb_offset, copy.rgb);
  if (entry.mask_offset != 0) {
    copy.mask.resize(n);
    map_.ReadAt(entry.mask_offset, copy.mask);
  }
  return copy;
}

bool PixelCache::Pixel(size_t photo, size_t pixel, uint8_t rgb[3]) const {
  const Entry& entry = entries_[photo];
  if (streaming_) {
    uint8_t counts = 1;
    if (entry.mask_offset != 0) map_.ReadAt(entry.mask_offset + pixel, {&counts, 1});
    if (counts != 0) map_.ReadAt(entry.rgb_offset + 3 * pixel, {rgb, 3});
    return counts != 0;
  }
  const uint8_t* bytes = map_.bytes().data();
  if (entry.mask_offset != 0 && bytes[entry.mask_offset + pixel] == 0) return false;
  std::copy_n(bytes + entry.rgb_offset + 3 * pixel, 3, rgb);
  return true;
}

bool PixelCache::MeanLight(size_t photo, int x, int y, int size, float light[3]) const {
  static const std::array<float, 256> linear = [] {
    std::array<float, 256> values{};
    for (size_t i = 0; i < values.size(); ++i) values[i] = LinearFromSrgb(static_cast<float>(i) / 255.0F);
    return values;
  }();
  int counted = 0;
  float sum[3] = {0.0F, 0.0F, 0.0F};
  for (int row = y; row < y + size; ++row) {
    for (int column = x; column < x + size; ++column) {
      uint8_t rgb[3];
      const size_t pixel = static_cast<size_t>(row) * static_cast<size_t>(entries_[photo].width) + static_cast<size_t>(column);
      if (!Pixel(photo, pixel, rgb)) continue;
      for (size_t c = 0; c < 3; ++c) sum[c] += linear[rgb[c]];
      ++counted;
    }
  }
  if (2 * counted < size * size) return false;
  for (size_t c = 0; c < 3; ++c) light[c] = sum[c] / static_cast<float>(counted);
  return true;
}

}  // namespace skyquilt::image
