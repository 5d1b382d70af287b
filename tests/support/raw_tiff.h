// TIFF files written byte by byte, independently of the code under test.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace skyquilt::test {

struct RawTiff {
  int width = 0, height = 0, bands = 3;
  int bits = 16;  // 8, 16 or 32
  bool floating = false;
  int photometric = 2;                     // 1 black is zero, 2 RGB, 5 separated (CMYK)
  std::vector<uint16_t> extra;             // ExtraSamples: 0 unspecified, 2 alpha
  std::vector<uint8_t> pixels;             // little-endian, row by row, band after band in each pixel
  std::map<uint16_t, uint16_t> more = {};  // further tags with one number
};

// Little-endian, one uncompressed strip.
inline std::string TiffBytes(const RawTiff& tiff) {
  std::map<uint16_t, std::pair<uint16_t, std::vector<uint32_t>>> tags;  // type 3: 16 bits, 4: 32 bits
  const auto shorts = [](size_t n, uint32_t value) {
    return std::pair<uint16_t, std::vector<uint32_t>>(uint16_t{3}, std::vector<uint32_t>(n, value));
  };
  const auto n_bands = static_cast<size_t>(tiff.bands);
  tags[256] = {4, {static_cast<uint32_t>(tiff.width)}};
  tags[257] = {4, {static_cast<uint32_t>(tiff.height)}};
  tags[258] = shorts(n_bands, static_cast<uint32_t>(tiff.bits));
  tags[259] = shorts(1, 1);
  tags[262] = shorts(1, static_cast<uint32_t>(tiff.photometric));
  tags[273] = {4, {0}};
  tags[277] = shorts(1, static_cast<uint32_t>(tiff.bands));
  tags[278] = {4, {static_cast<uint32_t>(tiff.height)}};
  tags[279] = {4, {static_cast<uint32_t>(tiff.pixels.size())}};
  tags[284] = shorts(1, 1);
  if (!tiff.extra.empty()) tags[338] = {3, {tiff.extra.begin(), tiff.extra.end()}};
  tags[339] = shorts(n_bands, tiff.floating ? 3 : 1);
  for (const auto& [tag, value] : tiff.more) tags[tag] = shorts(1, value);

  const size_t values_at = 8 + 2 + 12 * tags.size() + 4;
  size_t values_size = 0;
  for (const auto& [tag, entry] : tags) {
    const size_t size = (entry.first == 3 ? 2 : 4) * entry.second.size();
    if (size > 4) values_size += size + size % 2;
  }
  tags[273].second[0] = static_cast<uint32_t>(values_at + values_size);

  std::string directory("II*\0\x08\0\0\0", 8), values;
  const auto put = [](std::string& to, uint32_t value, size_t size) {
    for (size_t i = 0; i < size; ++i) to += static_cast<char>(value >> 8U * i & 0xFFU);
  };
  put(directory, static_cast<uint32_t>(tags.size()), 2);
  for (const auto& [tag, entry] : tags) {
    const auto& [type, numbers] = entry;
    const size_t size = type == 3 ? 2 : 4;
    put(directory, tag, 2);
    put(directory, type, 2);
    put(directory, static_cast<uint32_t>(numbers.size()), 4);
    std::string bytes;
    for (const uint32_t number : numbers) put(bytes, number, size);
    if (bytes.size() > 4) {
      put(directory, static_cast<uint32_t>(values_at + values.size()), 4);
      values += bytes;
      if (values.size() % 2 != 0) values += '\0';
    } else {
      bytes.resize(4, '\0');
      directory += bytes;
    }
  }
  put(directory, 0, 4);
  return directory + values + std::string(tiff.pixels.begin(), tiff.pixels.end());
}

// Numbers as little-endian bytes.
template <typename T>
std::vector<uint8_t> LittleEndian(std::span<const T> numbers) {
  std::vector<uint8_t> bytes(numbers.size_bytes());
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

}  // namespace skyquilt::test
