// Points of a cloud as they stand in an EPT dataset, and the octree's nodes.
#pragma once

#include <array>
#include <bit>
#include <compare>
#include <cstdint>
#include <string>

namespace skyquilt::odm::ept {

static_assert(std::endian::native == std::endian::little, "EPT's binary data are little-endian");

// A record of the data type "binary", in the order of ept.json's schema, without gaps.
constexpr size_t kRecordBytes = 20;
struct Point {
  std::array<int32_t, 3> xyz = {};  // whole numbers of the cloud's scale from its offset
  std::array<uint16_t, 3> rgb = {};
  uint8_t classification = 0;
  uint8_t user_data = 0;  // number of views
};
static_assert(sizeof(Point) == kRecordBytes);

// Depth and place of a node: cube (x, y, z) of 2^depth per axis.
struct NodeKey {
  int depth = 0;
  std::array<int32_t, 3> cell = {};
  auto operator<=>(const NodeKey&) const = default;
  // "2-1-0-3"
  std::string Name() const {
    return std::to_string(depth) + "-" + std::to_string(cell[0]) + "-" + std::to_string(cell[1]) + "-" + std::to_string(cell[2]);
  }
};

// The cube of the whole dataset, in the points' whole numbers, which makes every division exact.
struct Cube {
  std::array<int64_t, 3> low = {};
  int64_t size = 1;  // a power of two

  int Levels() const { return static_cast<int>(std::bit_width(static_cast<uint64_t>(size))) - 1; }  // log2 of the size
  // Cell of a point among 2^depth per axis, where 2^depth <= size.
  std::array<int32_t, 3> CellOf(const Point& point, int depth) const {
    std::array<int32_t, 3> cell;
    const int64_t width = size >> depth;
    for (size_t axis = 0; axis < 3; ++axis) cell[axis] = static_cast<int32_t>((point.xyz[axis] - low[axis]) / width);
    return cell;
  }
};

}  // namespace skyquilt::odm::ept
