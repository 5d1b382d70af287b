#include "core/survey/dji_maker_note.h"

#include <bit>
#include <cmath>

namespace skyquilt::survey {
namespace {

constexpr size_t kEntryBytes = 12;  // tag, type, count, value
constexpr uint32_t kSpeedX = 3;
constexpr uint32_t kSpeedY = 4;
constexpr uint32_t kFloat = 11;
constexpr double kImpossible_mps = 200.0;

uint32_t Number(std::span<const uint8_t> bytes, bool little_endian) {
  uint32_t value = 0;
  for (size_t i = 0; i < bytes.size(); ++i) value = (value << 8U) | bytes[little_endian ? bytes.size() - 1 - i : i];
  return value;
}

}  // namespace

std::optional<double> DjiMakerNoteSpeed(std::span<const uint8_t> note, bool little_endian) {
  if (note.size() < 2) return std::nullopt;
  const size_t n_entries = Number(note.first(2), little_endian);
  if (n_entries * kEntryBytes + 2 > note.size()) return std::nullopt;
  std::optional<double> x;
  std::optional<double> y;
  for (size_t i = 0; i < n_entries; ++i) {
    const std::span<const uint8_t> entry = note.subspan(2 + i * kEntryBytes, kEntryBytes);
    const uint32_t tag = Number(entry.first(2), little_endian);
    const bool is_float = Number(entry.subspan(2, 2), little_endian) == kFloat && Number(entry.subspan(4, 4), little_endian) == 1;
    if (!is_float || (tag != kSpeedX && tag != kSpeedY)) continue;
    (tag == kSpeedX ? x : y) = static_cast<double>(std::bit_cast<float>(Number(entry.subspan(8, 4), little_endian)));
  }
  if (!x || !y) return std::nullopt;
  const double speed = std::hypot(*x, *y);
  return speed < kImpossible_mps ? std::optional<double>(speed) : std::nullopt;
}

}  // namespace skyquilt::survey
