// Predicts the error of a rendered pixel from what is known about it, with weights fitted to pixels whose error was measured.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/render/ray.h"
#include "core/trust/evidence.h"

namespace skyquilt::trust {

// What is known about a rendered pixel without its photo.
struct PixelFacts {
  Evidence evidence;           // of the place that it shows
  float opacity = 0.0F;        // 0 to 1
  float spread_pixels = 0.0F;  // how thick the surface is along the ray: depth_back - depth_front over the pixel's width; NaN: it has no back
  float gradient = 0.0F;       // of the rendering: largest slope over red, green and blue, display values per pixel
};

class ErrorModel {
 public:
  ErrorModel() = default;  // predicts the same for every pixel
  // A linear model of the logarithm of the squared error, by least squares, and a monotone map from its value to the mean squared error that pixels
  // with such a value had (isotonic regression over groups of the same size), so that predictions are right on average and not only in order.
  // Both spans have the same length; with less than 100 pixels the model predicts their mean.
  ErrorModel(std::span<const PixelFacts> facts, std::span<const float> squared_error);

  // Root mean square error that such pixels have, display values from 0 to 1, mean of the colours. Finite and positive.
  float RmsError(const PixelFacts& facts) const;

  // Under "error_model/".
  void Put(checkpoint::ArchiveWriter& writer) const;
  // Throws base::InputError when arrays are absent or not of this form.
  static ErrorModel Get(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

 private:
  static constexpr size_t kFeatures = 7;
  static std::array<double, kFeatures> FeaturesOf(const PixelFacts& facts);
  double Value(const PixelFacts& facts) const;

  std::array<double, kFeatures> weights_{};
  // Ascending values of the linear model, and the logarithm of the mean squared error there, ascending. One knot: it is the same everywhere.
  std::vector<double> knots_{0.0}, log_error_{-6.0};
};

}  // namespace skyquilt::trust
