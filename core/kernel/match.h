// Compares windows of one picture with another picture under planes: the inner loop of finding depth from photos.
// Both are pinhole pictures without distortion; pixel (x, y) has its middle at (x, y), so the first pixel's is (0, 0).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::kernel {

// A grey picture in which one load gets the four pixels that bilinear interpolation needs.
class MatchPicture {
 public:
  MatchPicture() = default;
  // grey: row-major, width * height bytes; width and height at least 2.
  MatchPicture(std::span<const uint8_t> grey, int width, int height);
  int width() const { return width_; }
  int height() const { return height_; }
  size_t bytes() const { return quads_.size() * sizeof(uint32_t); }
  float At(int x, int y) const { return static_cast<float>(quads_[Index(x, y)] & 0xffU); }
  const uint32_t* quads() const { return quads_.data(); }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x); }

  int width_ = 0, height_ = 0;
  std::vector<uint32_t> quads_;  // pixels (x, y), (x + 1, y), (x, y + 1) and (x + 1, y + 1), from the lowest byte; repeated at the border
};

constexpr int kMatchPixels = 64;                 // pixels of a row that are compared in one call
constexpr int kMatchRadius = 4, kMatchStep = 2;  // of a window and between its samples, pixels
constexpr int kMatchSide = 2 * kMatchRadius / kMatchStep + 1;
constexpr int kMatchSamples = kMatchSide * kMatchSide;
constexpr float kNoMatch = -2.0F;  // instead of a correlation

// Windows around some pixels of a row. Weights fall with distance and with the difference to the middle pixel (bilateral), so that a
// window keeps to one surface; they sum to 1.
struct MatchWindows {
  int y = 0, count = 0;  // how many pixels, at most kMatchPixels
  std::array<float, kMatchPixels> x, mean, variance;
  std::array<float, kMatchPixels * kMatchSamples> value, weight;

  // Leaves those at these places, which are in ascending order.
  void Keep(std::span<const int> places);
};
// Of the pixels from x to x + count - 1.
void FillMatchWindows(const MatchPicture& picture, int x, int y, int count, MatchWindows* windows);

// Where a plane's points are in the other picture: pixel (x, y) at inverse depth a is at the homogeneous position H (x, y, 1) + a t. H and t are in
// pixels of both pictures, H row-major.
struct MatchTransform {
  std::array<float, 9> h;
  std::array<float, 3> t;
};

// Planes, one per pixel: inverse depth along the optical axis at the pixel, and its slopes per pixel to the right and down. Arrays as long as
// kMatchPixels.
struct MatchPlanes {
  const float* inverse_depth;
  const float* slope_x;
  const float* slope_y;
};

// Normalised cross-correlation of each window with the other picture under its plane, in [-1, 1]; kNoMatch where a sample is outside or behind it, or
// one of the windows is all one colour. correlation: kMatchPixels values, those beyond windows.count are not to be used.
void MatchUnderPlanes(const MatchWindows& windows, const MatchPicture& other, const MatchTransform& transform, const MatchPlanes& planes,
                      float* correlation);

}  // namespace skyquilt::kernel
