// Brings the photos of a map into one light: a gain per photo and colour, and for each camera the light that its lens loses towards the corners.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::products {

struct PhotoLight {
  std::vector<std::array<float, 3>> gain;     // per photo: factor on linear light
  std::vector<std::array<float, 2>> falloff;  // per camera: a, b of the factor exp(a r^2 + b r^4), r = 1 in the farthest corner

  // No photo is changed.
  static PhotoLight None(size_t photos, size_t cameras);
  // Factors of a photo's pixel at r^2 = radius2.
  std::array<float, 3> At(size_t photo, size_t camera, float radius2) const;
};

// A place that a photo shows: natural logarithm of the wanted linear light over the photo's, per colour; NaN: not known.
struct LightSample {
  int32_t photo = 0;
  float radius2 = 0.0F;
  std::array<float, 3> log_ratio{};
};

// Robust: medians for the gains, and samples more than three standard deviations off do not count for the falloff, which stays 0 for a camera with
// few samples or with none in its corners. Photos without samples get the median gain of all. camera_of_photo: index per photo.
PhotoLight FitLight(std::span<const LightSample> samples, std::span<const int> camera_of_photo, size_t cameras);

}  // namespace skyquilt::products
