#include "core/image/pixel_format.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <vector>

#include "core/base/memory_map.h"
#include "core/image/jpeg_structure.h"

namespace skyquilt::image {
namespace {

using Bytes = std::span<const uint8_t>;

// Numbers of a TIFF header in the file's byte order; nothing beyond the end of the file.
class TiffReader {
 public:
  TiffReader(Bytes bytes, bool big_endian) : bytes_(bytes), big_endian_(big_endian) {}

  std::optional<uint64_t> Unsigned(uint64_t at, size_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    uint64_t value = 0;
    for (size_t i = 0; i < size; ++i) value = value << 8U | bytes_[at + (big_endian_ ? i : size - 1 - i)];
    return value;
  }

 private:
  Bytes bytes_;
  bool big_endian_;
};

// TIFF 6.0, section 2; BigTIFF has the last two.
size_t SizeOfType(uint64_t type) {
  switch (type) {
    case 1:  // BYTE
    case 6:  // SBYTE
      return 1;
    case 3:  // SHORT
    case 8:  // SSHORT
      return 2;
    case 4:   // LONG
    case 9:   // SLONG
    case 11:  // FLOAT
      return 4;
    case 5:   // RATIONAL
    case 12:  // DOUBLE
    case 16:  // LONG8
      return 8;
    default:
      return 0;
  }
}

std::optional<double> NumberOf(const TiffReader& reader, uint64_t type, uint64_t at) {
  const std::optional<uint64_t> raw = reader.Unsigned(at, SizeOfType(type));
  if (!raw) return std::nullopt;
  switch (type) {
    case 5: {
      const std::optional<uint64_t> numerator = reader.Unsigned(at, 4), denominator = reader.Unsigned(at + 4, 4);
      if (!numerator || !denominator || *denominator == 0) return std::nullopt;
      return static_cast<double>(*numerator) / static_cast<double>(*denominator);
    }
    case 6:
      return static_cast<double>(static_cast<int8_t>(*raw));
    case 8:
      return static_cast<double>(static_cast<int16_t>(*raw));
    case 9:
      return static_cast<double>(static_cast<int32_t>(*raw));
    case 11:
      return static_cast<double>(std::bit_cast<float>(static_cast<uint32_t>(*raw)));
    case 12:
      return std::bit_cast<double>(*raw);
    default:
      return static_cast<double>(*raw);
  }
}

// The first directory of a TIFF: those numbers of a tag that are asked for.
class TiffDirectory {
 public:
  explicit TiffDirectory(Bytes bytes) : reader_(bytes, bytes[0] == 'M') {
    is_big_ = reader_.Unsigned(2, 2) == 43;
    const std::optional<uint64_t> at = is_big_ ? reader_.Unsigned(8, 8) : reader_.Unsigned(4, 4);
    const std::optional<uint64_t> count = at ? reader_.Unsigned(*at, is_big_ ? 8 : 2) : std::nullopt;
    if (!count) return;
    first_ = *at + (is_big_ ? 8 : 2);
    n_entries_ = std::min<uint64_t>(*count, 65535);
  }

  // At most 64; empty when the tag is missing or damaged.
  std::vector<double> Numbers(uint64_t tag) const {
    const uint64_t entry_bytes = is_big_ ? 20 : 12, count_bytes = is_big_ ? 8 : 4;
    for (uint64_t i = 0; i < n_entries_; ++i) {
      const uint64_t entry = first_ + i * entry_bytes;
      if (reader_.Unsigned(entry, 2) != tag) continue;
      const std::optional<uint64_t> type = reader_.Unsigned(entry + 2, 2), count = reader_.Unsigned(entry + 4, count_bytes);
      if (!type || !count || SizeOfType(*type) == 0) return {};
      const uint64_t size = SizeOfType(*type), wanted = std::min<uint64_t>(*count, 64);
      uint64_t at = entry + 4 + count_bytes;
      if (*count > count_bytes / size) {
        const std::optional<uint64_t> elsewhere = reader_.Unsigned(at, count_bytes);
        if (!elsewhere) return {};
        at = *elsewhere;
      }
      std::vector<double> numbers;
      for (uint64_t k = 0; k < wanted; ++k) {
        const std::optional<double> number = NumberOf(reader_, *type, at + k * size);
        if (!number) return {};
        numbers.push_back(*number);
      }
      return numbers;
    }
    return {};
  }
  std::optional<double> Number(uint64_t tag) const {
    const std::vector<double> numbers = Numbers(tag);
    return numbers.empty() ? std::nullopt : std::optional(numbers.front());
  }

 private:
  TiffReader reader_;
  bool is_big_ = false;
  uint64_t first_ = 0, n_entries_ = 0;
};

int Side(std::optional<double> number) {
  return number && *number >= 1.0 && *number <= 1e6 ? static_cast<int>(*number) : 0;
}

// The largest of the bands' white values, where it says something.
std::optional<double> WhiteOf(const TiffDirectory& tags, const PixelFormat& format) {
  constexpr std::array<uint64_t, 3> kTags = {50717, 341, 281};  // WhiteLevel, SMaxSampleValue, MaxSampleValue
  for (const uint64_t tag : kTags) {
    const std::vector<double> numbers = tags.Numbers(tag);
    if (numbers.empty()) continue;
    const double most = *std::max_element(numbers.begin(), numbers.end());
    const bool of_type = !format.floating && most >= std::exp2(format.bits) - 1.0;
    if (std::isfinite(most) && most > 0.0 && !of_type) return most;
  }
  return std::nullopt;
}

PixelFormat FormatOfTiff(Bytes bytes) {
  enum Photometric { kBlackIsZero = 1, kRgb = 2, kPalette = 3, kSeparated = 5, kYcbcr = 6 };
  const TiffDirectory tags(bytes);
  PixelFormat format;
  format.kind = FileKind::kTiff;
  format.width = Side(tags.Number(256));
  format.height = Side(tags.Number(257));
  const std::vector<double> bits = tags.Numbers(258);
  format.bits = bits.empty() ? 1 : static_cast<int>(std::clamp(*std::max_element(bits.begin(), bits.end()), 1.0, 64.0));
  format.bands = static_cast<int>(std::clamp(tags.Number(277).value_or(1.0), 1.0, 65535.0));
  format.floating = tags.Number(339).value_or(1.0) == 3.0;
  const int photometric = static_cast<int>(tags.Number(262).value_or(kBlackIsZero));
  format.has_palette = photometric == kPalette;
  format.is_rgb = photometric == kRgb || photometric == kYcbcr;
  format.is_cmyk = photometric == kSeparated && format.bands >= 4;
  const std::vector<double> extra = tags.Numbers(338);
  // 1 and 2 are alpha, with and without premultiplied colours.
  for (size_t i = extra.size(); i > 0 && (extra[i - 1] == 1.0 || extra[i - 1] == 2.0); --i) ++format.alpha_bands;
  format.white = WhiteOf(tags, format);
  return format;
}

PixelFormat FormatOfPng(Bytes bytes) {
  PixelFormat format;
  format.kind = FileKind::kPng;
  if (bytes.size() < 26 || std::memcmp(bytes.data() + 12, "IHDR", 4) != 0) return format;
  const TiffReader reader(bytes, true);
  format.width = Side(static_cast<double>(*reader.Unsigned(16, 4)));
  format.height = Side(static_cast<double>(*reader.Unsigned(20, 4)));
  format.bits = bytes[24];
  const int colour_type = bytes[25];
  format.has_palette = colour_type == 3;
  format.is_rgb = (colour_type & 2) != 0;
  format.alpha_bands = (colour_type & 4) != 0 ? 1 : 0;
  format.bands = (format.is_rgb && !format.has_palette ? 3 : 1) + format.alpha_bands;
  return format;
}

}  // namespace

PixelFormat ReadPixelFormat(const std::filesystem::path& file) {
  return PixelFormatOf(base::MemoryMap(file).bytes());
}

PixelFormat PixelFormatOf(Bytes bytes) {
  const auto starts_with = [&](std::string_view magic) {
    return bytes.size() >= magic.size() && std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
  };
  using namespace std::string_view_literals;
  if (starts_with("\x89PNG\r\n\x1A\n"sv)) return FormatOfPng(bytes);
  const bool is_tiff = starts_with("II*\0"sv) || starts_with("MM\0*"sv) || starts_with("II+\0"sv) || starts_with("MM\0+"sv);
  if (is_tiff) return FormatOfTiff(bytes);
  PixelFormat format;
  const JpegStructure jpeg = ParseJpeg(bytes, true);
  if (!jpeg.is_jpeg) return format;
  format.kind = FileKind::kJpeg;
  format.width = jpeg.width;
  format.height = jpeg.height;
  format.bits = jpeg.bits;
  format.bands = jpeg.components;
  format.is_rgb = jpeg.components >= 3;
  return format;
}

bool IsPlain(const PixelFormat& format) {
  if (format.kind != FileKind::kTiff && format.kind != FileKind::kPng) return true;
  if (format.bands == 0 || format.bits == 0) return true;
  if (format.floating || format.bits > 8 || format.is_cmyk) return false;
  const int colours = format.bands - std::min(format.alpha_bands, format.bands - 1);
  if (colours == 1) return format.kind == FileKind::kPng || format.bands == 1;
  // Three bands are taken as red, green and blue whatever the tags say, as most programs do.
  return colours == 3 ? format.bands <= 4 : format.is_rgb && format.bands == 4;
}

}  // namespace skyquilt::image
