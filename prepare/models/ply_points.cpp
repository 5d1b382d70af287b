#include "prepare/models/ply_points.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <sstream>
#include <string>
#include <string_view>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::prepare::models {
namespace {

constexpr const char* kPlyFix = "Export the points again as PLY with x, y and z, or remove the entry ply_file_path";

struct PlyProperty {
  char type = 'f';  // of a C type: b B h H i I f d
  int slot = -1;    // 0..2 x y z, 3..5 red green blue, -1 skipped
};

size_t SizeOfType(char type) {
  switch (type) {
    case 'b':
    case 'B':
      return 1;
    case 'h':
    case 'H':
      return 2;
    case 'd':
      return 8;
    default:
      return 4;
  }
}

char TypeOf(const std::string& name) {
  if (name == "char" || name == "int8") return 'b';
  if (name == "uchar" || name == "uint8") return 'B';
  if (name == "short" || name == "int16") return 'h';
  if (name == "ushort" || name == "uint16") return 'H';
  if (name == "int" || name == "int32") return 'i';
  if (name == "uint" || name == "uint32") return 'I';
  if (name == "float" || name == "float32") return 'f';
  if (name == "double" || name == "float64") return 'd';
  return '\0';
}

template <typename T>
double Loaded(std::array<char, 8> bytes, bool swap) {
  if (swap) std::reverse(bytes.begin(), bytes.begin() + sizeof(T));
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return static_cast<double>(value);
}

double BinaryNumber(const char* data, char type, bool swap) {
  std::array<char, 8> bytes{};
  std::memcpy(bytes.data(), data, SizeOfType(type));
  switch (type) {
    case 'b':
      return Loaded<int8_t>(bytes, swap);
    case 'B':
      return Loaded<uint8_t>(bytes, swap);
    case 'h':
      return Loaded<int16_t>(bytes, swap);
    case 'H':
      return Loaded<uint16_t>(bytes, swap);
    case 'i':
      return Loaded<int32_t>(bytes, swap);
    case 'I':
      return Loaded<uint32_t>(bytes, swap);
    case 'd':
      return Loaded<double>(bytes, swap);
    default:
      return Loaded<float>(bytes, swap);
  }
}

class PlyReader {
 public:
  explicit PlyReader(const std::filesystem::path& file) : file_(file), text_(base::ReadFile(file)) {}

  std::vector<PlyPoint> Read() {
    ReadHeader();
    std::vector<PlyPoint> points;
    const size_t least = ascii_ ? 2 * properties_.size() : stride_;
    if (count_ > (text_.size() - at_ + 1) / std::max<size_t>(least, 1)) {
      throw base::InputError(file_, "says that it has " + std::to_string(count_) + " points, but is too short for them", kPlyFix);
    }
    points.reserve(count_);
    for (size_t i = 0; i < count_; ++i) points.push_back(ascii_ ? AsciiPoint() : BinaryPoint());
    return points;
  }

 private:
  [[noreturn]] void FailLine(const std::string& found) const {
    throw base::InputError(file_, "line " + std::to_string(line_) + ": " + found, kPlyFix);
  }
  std::string_view NextLine() {
    if (at_ >= text_.size()) FailLine("the file ends too early");
    ++line_;
    const size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = std::string_view(text_).substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  void ReadHeader() {
    if (NextLine() != "ply") FailLine("is not a PLY file");
    bool in_vertex = false, vertex_seen = false, other_first = false;
    while (true) {
      std::istringstream words{std::string(NextLine())};
      std::string word, first, second;
      words >> word >> first >> second;
      if (word == "end_header") break;
      if (word == "format") {
        ascii_ = first == "ascii";
        if (!ascii_ && first != "binary_little_endian" && first != "binary_big_endian") FailLine("has an unknown format " + first);
        swap_ = (first == "binary_big_endian") == (std::endian::native == std::endian::little);
      } else if (word == "element") {
        in_vertex = first == "vertex";
        if (!in_vertex && !vertex_seen) other_first = true;
        if (in_vertex) {
          const auto result = std::from_chars(second.data(), second.data() + second.size(), count_);
          if (result.ec != std::errc() || result.ptr != second.data() + second.size()) FailLine("has no number of points");
          vertex_seen = true;
        }
      } else if (word == "property" && in_vertex) {
        PlyProperty property{.type = TypeOf(first)};
        if (property.type == '\0') FailLine("has a property of type '" + first + "', which cannot be read");
        const std::string_view names[] = {"x", "y", "z", "red", "green", "blue"};
        for (int slot = 0; slot < 6; ++slot) {
          if (second == names[slot]) property.slot = slot;
        }
        properties_.push_back(property);
        stride_ += SizeOfType(property.type);
      }
    }
    int position = 0;
    for (const PlyProperty& property : properties_) position += property.slot >= 0 && property.slot < 3 ? 1 : 0;
    if (!vertex_seen || other_first || position != 3) FailLine("the header has no element vertex with x, y and z as its first");
  }
  PlyPoint Made(const std::array<double, 6>& slots) const {
    PlyPoint point{.x = {slots[0], slots[1], slots[2]}};
    if (!point.x.allFinite()) FailLine("a point is not finite");
    for (size_t i = 0; i < 3; ++i) point.rgb[i] = static_cast<uint8_t>(std::clamp(slots[i + 3], 0.0, 255.0));
    return point;
  }
  PlyPoint AsciiPoint() {
    std::string_view line = NextLine();
    std::array<double, 6> slots{};
    for (const PlyProperty& property : properties_) {
      line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
      double value = 0.0;
      const auto result = std::from_chars(line.data(), line.data() + line.size(), value);
      if (result.ec != std::errc()) FailLine("has fewer than " + std::to_string(properties_.size()) + " numbers");
      line.remove_prefix(static_cast<size_t>(result.ptr - line.data()));
      if (property.slot >= 0) slots[static_cast<size_t>(property.slot)] = std::isnan(value) && property.slot > 2 ? 0.0 : value;
    }
    return Made(slots);
  }
  PlyPoint BinaryPoint() {
    if (text_.size() - at_ < stride_) throw base::InputError(file_, "ends too early", kPlyFix);
    std::array<double, 6> slots{};
    for (const PlyProperty& property : properties_) {
      const double value = BinaryNumber(text_.data() + at_, property.type, swap_);
      at_ += SizeOfType(property.type);
      if (property.slot >= 0) slots[static_cast<size_t>(property.slot)] = std::isnan(value) && property.slot > 2 ? 0.0 : value;
    }
    return Made(slots);
  }

  std::filesystem::path file_;
  std::string text_;
  size_t at_ = 0, line_ = 0, count_ = 0, stride_ = 0;
  bool ascii_ = true, swap_ = false;
  std::vector<PlyProperty> properties_;
};

}  // namespace

std::vector<PlyPoint> ReadPlyPoints(const std::filesystem::path& file) {
  return PlyReader(file).Read();
}

}  // namespace skyquilt::prepare::models
