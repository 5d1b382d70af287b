// Shading: light that differs within a photo, because the shadow of a cloud lies over a part of what it shows. A coarse grid of log gains over the
// picture, the same for all colours, interpolated bilinearly between its knots, which reach from border to border.
// What shading must not take over is kept from it by a projection (CentreShading), not by a penalty: light that all photos share at the same place of
// the picture belongs to the scene or to the lens, and the mean light of a photo to its gain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace skyquilt::brightness {

// Natural logarithm of the largest accepted factor of a knot before the projection: three stops.
constexpr float kMaxLogShading = 2.0794415F;

// Place in a picture, x and y from 0 (left and upper border) to 1; independent of the size at which a photo is read.
using PicturePlace = std::array<float, 2>;

struct ShadingGrid {
  int columns = 0, rows = 0;  // knots along the picture's width and height, at least 2; 0: no shading

  bool On() const { return columns > 0; }
  size_t knots() const { return static_cast<size_t>(columns) * static_cast<size_t>(rows); }
  bool operator==(const ShadingGrid&) const = default;

  // "8x6" (columns x rows), both 2 to 32; empty for any other text.
  static std::optional<ShadingGrid> Parse(std::string_view text);
};

// What is learned, and the prior of it.
struct ShadingOptions {
  ShadingGrid grid;
  std::vector<uint8_t> learns;  // per photo: 1 has a shading, 0 has none
  float sigma = 0.0F;           // standard deviation of the log gain within a photo, > 0

  bool On() const { return grid.On(); }
};

// Scatter of the logarithm of light that shading is weighed against: what a field or tie points leave unexplained.
constexpr double kShadingScatter = 0.15;
// Neighbouring knots differ less than knots far apart: the prior of a difference is this many times as strong as that of a knot.
constexpr double kShadingSmoothness = 4.0;

// The knots around a place, row by row, and their weights, which sum to 1.
struct KnotWeights {
  std::array<size_t, 4> knot;
  std::array<float, 4> weight;
};
KnotWeights KnotsAt(const ShadingGrid& grid, const PicturePlace& place);

// Per knot the mean of its weight over the picture; they sum to 1.
std::vector<double> KnotShares(const ShadingGrid& grid);

// The gradient of 1/2 sum s_k^2 + 1/2 kShadingSmoothness sum (s_k - s_l)^2, over knots and pairs of neighbours, added `strength` times to `gradient`.
void AddShadingPrior(const ShadingGrid& grid, std::span<const float> log_shading, double strength, std::span<double> gradient);
void AddShadingPrior(const ShadingGrid& grid, std::span<const double> log_shading, double strength, std::span<double> gradient);

// Takes out of [photo][knot] what is not shading, for the photos that learn: the mean over these photos at every knot, and the mean over the picture
// of every photo. Both means are zero afterwards, and nothing else has changed (it is an orthogonal projection in the picture's measure). The others
// keep their values.
void CentreShading(const ShadingGrid& grid, std::span<const uint8_t> learns, std::span<float> log_shading);

}  // namespace skyquilt::brightness
