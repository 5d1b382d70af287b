// Places rectangles in one picture.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

namespace skyquilt::surface {

// Width and height are multiples of this: the largest block of a JPEG.
constexpr int kAtlasMultiple = 16;

struct Packing {
  int width = 0, height = 0;
  std::vector<Eigen::Vector2i> corner;  // upper left one of each rectangle
};

// Rows of rectangles sorted by height, each in the first row with room for it (first fit decreasing height, Coffman et al. 1980); of several widths
// the one that needs the smallest area. Sizes are at least 1. Nothing when neither side can stay within limit.
std::optional<Packing> PackRows(std::span<const Eigen::Vector2i> sizes, int limit);

}  // namespace skyquilt::surface
