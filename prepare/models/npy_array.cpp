#include "prepare/models/npy_array.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::prepare::models {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
// NumPy's own headers are below 200 bytes.
constexpr size_t kLongestHeader = 4096;

// What follows `key` in the header, from its first character that is no space.
std::string_view ValueOf(std::string_view header, std::string_view key) {
  const std::string quoted = "'" + std::string(key) + "'";
  const size_t at = header.find(quoted);
  if (at == std::string_view::npos) return {};
  size_t begin = header.find_first_not_of(" \t", at + quoted.size());
  if (begin == std::string_view::npos || header[begin] != ':') return {};
  begin = header.find_first_not_of(" \t", begin + 1);
  return begin == std::string_view::npos ? std::string_view() : header.substr(begin);
}

// Of "(20, 17)", also with a comma at its end; nothing when it is no such list.
std::optional<std::vector<size_t>> ShapeOf(std::string_view text) {
  if (!text.starts_with('(')) return std::nullopt;
  const size_t end = text.find(')');
  if (end == std::string_view::npos) return std::nullopt;
  std::vector<size_t> shape;
  for (std::string_view rest = text.substr(1, end - 1);;) {
    const size_t begin = rest.find_first_not_of(" \t");
    if (begin == std::string_view::npos) return shape;
    rest.remove_prefix(begin);
    size_t number = 0;
    const auto [after, error] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (error != std::errc()) return std::nullopt;
    shape.push_back(number);
    rest.remove_prefix(static_cast<size_t>(after - rest.data()));
    const size_t comma = rest.find_first_not_of(" \t");
    if (comma == std::string_view::npos) return shape;
    if (rest[comma] != ',') return std::nullopt;
    rest.remove_prefix(comma + 1);
  }
}

template <typename T>
void Append(std::string_view bytes, std::vector<double>* values) {
  static_assert(std::numeric_limits<T>::is_iec559);
  for (size_t at = 0; at < bytes.size(); at += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    values->push_back(static_cast<double>(value));
  }
}

}  // namespace

NpyArray ReadNpyArray(const std::filesystem::path& file, const std::string& fix) {
  const auto fail = [&](const std::string& found) -> void { throw base::InputError(file, found, fix); };
  const std::string content = base::ReadFile(file);
  const std::string_view bytes = content;
  if (!bytes.starts_with(kMagic)) fail("is not an array that NumPy saved (.npy)");
  const auto byte = [&](size_t i) { return static_cast<size_t>(static_cast<unsigned char>(bytes[i])); };
  const size_t length_at = kMagic.size() + 2;
  const bool longer = bytes.size() > kMagic.size() && byte(kMagic.size()) > 1;
  const size_t header_at = length_at + (longer ? 4 : 2);
  if (bytes.size() < header_at) fail("ends within its header (truncated)");
  size_t length = byte(length_at) + 256 * byte(length_at + 1);
  if (longer) length += (byte(length_at + 2) << 16U) + (byte(length_at + 3) << 24U);
  if (length > kLongestHeader) fail("has a header of " + std::to_string(length) + " bytes (damaged)");
  if (bytes.size() - header_at < length) fail("ends within its header (truncated)");
  const std::string_view header = bytes.substr(header_at, length);

  const std::string_view type = ValueOf(header, "descr");
  const bool wide = type.starts_with("'<f8'");
  if (!wide && !type.starts_with("'<f4'")) fail("does not hold little-endian floating-point numbers ('<f8' or '<f4')");
  if (!ValueOf(header, "fortran_order").starts_with("False")) fail("is not stored row after row (fortran_order must be False)");
  const std::optional<std::vector<size_t>> shape = ShapeOf(ValueOf(header, "shape"));
  if (!shape) fail("has no shape in its header (damaged)");
  if (shape->size() != 2) fail("has " + std::to_string(shape->size()) + " dimensions, not 2");

  NpyArray array{.rows = (*shape)[0], .columns = (*shape)[1], .values = {}};
  const std::string_view data = bytes.substr(header_at + length);
  const size_t width = wide ? 8 : 4;
  const std::string size = std::to_string(array.rows) + " x " + std::to_string(array.columns) + " numbers";
  // Without a product, which could overflow.
  const size_t n = data.size() / width;
  if (array.columns > 0 && n / array.columns < array.rows) fail("ends before its " + size + " (truncated)");
  const bool whole = data.size() % width == 0 && (array.columns == 0 ? n == 0 : n % array.columns == 0 && n / array.columns == array.rows);
  if (!whole) fail("does not end after its " + size + " (damaged)");
  array.values.reserve(n);
  wide ? Append<double>(data, &array.values) : Append<float>(data, &array.values);
  for (size_t i = 0; i < array.values.size(); ++i) {
    if (!std::isfinite(array.values[i])) {
      fail("has a number that is not finite in row " + std::to_string(i / array.columns) + ", column " + std::to_string(i % array.columns));
    }
  }
  return array;
}

}  // namespace skyquilt::prepare::models
