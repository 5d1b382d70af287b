#include "simulate/cloud_shadows.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

constexpr int kOctaves = 3;
// Places whose pattern decides from which value on the wanted share is cloud, along each axis, and how far apart they are in wavelengths.
constexpr int kPlaces = 100;
constexpr float kApart = 0.37F;
// Slope of the pattern per wavelength below which the distance to an edge would be exaggerated.
constexpr float kLeastSlope = 1.0F;

}  // namespace

CloudShadows::CloudShadows(const CloudShadowSpec& spec, const Eigen::Vector3f& to_sun, uint32_t seed)
    : on_(spec.stops > 0.0), spec_(spec), to_sun_(to_sun), seed_(seed) {
  if (!on_) return;
  const float angle = 2.0F * std::numbers::pi_v<float> * HashUnit(1, 2, seed);
  wind_ = {std::cos(angle), std::sin(angle)};
  std::vector<float> values;
  const float step = kApart * static_cast<float>(spec.size_m);
  for (int i = 0; i < kPlaces; ++i) {
    for (int j = 0; j < kPlaces; ++j) values.push_back(Cloud(step * static_cast<float>(i), step * static_cast<float>(j)));
  }
  const auto below = static_cast<ptrdiff_t>((1.0 - spec.cover) * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + below, values.end());
  threshold_ = values[static_cast<size_t>(below)];
}

CloudShadows CloudShadows::At(double time_s) const {
  CloudShadows later = *this;
  later.drift_ = static_cast<float>(spec_.speed_mps * time_s) * wind_;
  return later;
}

float CloudShadows::Cloud(float x, float y) const {
  return FractalNoise(x, y, {static_cast<float>(spec_.size_m), kOctaves, 0.4F}, seed_, 0.0F);
}

float CloudShadows::SunShare(const Eigen::Vector3f& x_in_enu) const {
  if (!on_) return 1.0F;
  // Where the ray to the sun leaves the plane z = 0.
  const float x = x_in_enu.x() - x_in_enu.z() * to_sun_.x() / to_sun_.z() - drift_.x();
  const float y = x_in_enu.y() - x_in_enu.z() * to_sun_.y() / to_sun_.z() - drift_.y();
  const auto size = static_cast<float>(spec_.size_m), reach = 0.02F * size;
  const float value = Cloud(x, y);
  const Eigen::Vector2f slope = Eigen::Vector2f(Cloud(x + reach, y) - value, Cloud(x, y + reach) - value) / reach;
  // Metres from the edge, to first order.
  const float inside = (value - threshold_) / std::max(slope.norm(), kLeastSlope / size);
  const auto half = 0.5F * static_cast<float>(spec_.penumbra_m);
  const float shadow = Smoothstep(-half, half, inside);
  return std::exp2(-static_cast<float>(spec_.stops) * shadow);
}

}  // namespace skyquilt::simulate
