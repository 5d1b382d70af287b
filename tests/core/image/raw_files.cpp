#include "tests/core/image/raw_files.h"

#include <fstream>

namespace skyquilt {
namespace {

std::string BigEndian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> static_cast<unsigned>(shift) & 0xFFU));
  return bytes;
}

uint32_t Crc32(const std::string& bytes) {
  uint32_t crc = 0xFFFFFFFFU;
  for (const char c : bytes) {
    crc ^= static_cast<uint8_t>(c);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

std::string Chunk(const std::string& type, const std::string& content) {
  return BigEndian(static_cast<uint32_t>(content.size())) + type + content + BigEndian(Crc32(type + content));
}

std::string StoredZlib(const std::string& bytes) {
  std::string out = "\x78\x01";
  uint32_t a = 1;
  uint32_t b = 0;
  for (const char c : bytes) {
    a = (a + static_cast<uint8_t>(c)) % 65521U;
    b = (b + a) % 65521U;
  }
  for (size_t at = 0; at < bytes.size(); at += 65535) {
    const std::string part = bytes.substr(at, 65535);
    const auto n = static_cast<uint16_t>(part.size());
    out.push_back(at + part.size() == bytes.size() ? '\1' : '\0');
    for (const unsigned value : {unsigned{n}, ~unsigned{n}}) {
      out.push_back(static_cast<char>(value & 0xFFU));
      out.push_back(static_cast<char>(value >> 8U & 0xFFU));
    }
    out += part;
  }
  return out + BigEndian(b << 16U | a);
}

}  // namespace

void WriteBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

std::string PngBytes(const RawPng& png) {
  std::string header = BigEndian(static_cast<uint32_t>(png.width)) + BigEndian(static_cast<uint32_t>(png.height));
  header += {static_cast<char>(png.bit_depth), static_cast<char>(png.colour_type), '\0', '\0', '\0'};
  const size_t row_bytes = png.pixels.size() / static_cast<size_t>(png.height);
  std::string rows;
  for (size_t y = 0; y < static_cast<size_t>(png.height); ++y) {
    rows.push_back('\0');  // no filter
    rows.append(reinterpret_cast<const char*>(png.pixels.data()) + y * row_bytes, row_bytes);
  }
  return "\x89PNG\r\n\x1A\n" + Chunk("IHDR", header) + Chunk("IDAT", StoredZlib(rows)) + Chunk("IEND", "");
}

image::Image8 Pattern(int width, int height) {
  image::Image8 image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.At(x, y)[0] = static_cast<uint8_t>((x * 7 + y * 3) % 256);
      image.At(x, y)[1] = static_cast<uint8_t>((x * 2 + y * 5 + 40) % 256);
      image.At(x, y)[2] = static_cast<uint8_t>((x * y + 90) % 256);
    }
  }
  return image;
}

}  // namespace skyquilt
