#include "simulate/sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {

using Eigen::Vector3f;

Sky::Sky(double sun_azimuth_deg, double sun_elevation_deg, double intensity, double clouds, uint32_t seed)
    : intensity_(static_cast<float>(intensity)), clouds_(static_cast<float>(clouds)), seed_(seed) {
  const double azimuth = sun_azimuth_deg * std::numbers::pi / 180.0;
  const double elevation = sun_elevation_deg * std::numbers::pi / 180.0;
  sun_direction_ =
      Eigen::Vector3d(std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation), std::sin(elevation)).cast<float>();
  // A low sun is dimmer and redder.
  const auto low = static_cast<float>(std::exp(-std::sin(elevation) / 0.25));
  sun_over_pi_ = intensity_ * Vector3f(1.22F - 0.3F * low, 1.13F - 0.5F * low, 0.98F - 0.7F * low);
  ground_radiance_ = 0.17F * (sun_over_pi_ * sun_direction_.z() + intensity_ * Vector3f(0.30F, 0.36F, 0.46F));
}

Vector3f Sky::Radiance(const Vector3f& direction) const {
  if (direction.z() <= 0.0F) return ground_radiance_;
  const float up = std::sqrt(direction.z());
  Vector3f clear = Vector3f(0.46F, 0.52F, 0.60F) * (1.0F - up) + Vector3f(0.23F, 0.31F, 0.47F) * up;
  if (clouds_ > 0.0F) {
    // Clouds on a plane above the ground.
    const float scale = 1.0F / (direction.z() + 0.12F);
    const float cover = FractalNoise(direction.x() * scale, direction.y() * scale, {0.8F, 4, 0.5F}, seed_, 0.02F);
    const float share = clouds_ * Smoothstep(-0.1F, 0.7F, cover);
    clear += share * (Vector3f(0.95F, 0.94F, 0.92F) - clear);
  }
  return intensity_ * clear;
}

Vector3f Sky::Seen(const Vector3f& direction) const {
  if (direction.z() <= 0.0F) return Radiance(direction);
  const float c = std::max(direction.dot(sun_direction_), 0.0F);
  return Radiance(direction) + 0.08F * c * c * sun_over_pi_ + SunGlow(direction);
}

Vector3f Sky::SunGlow(const Vector3f& direction) const {
  const float c = std::max(direction.dot(sun_direction_), 0.0F);
  const float c4 = c * c * c * c;
  const float c16 = c4 * c4 * c4 * c4;
  const float c64 = c16 * c16 * c16 * c16;
  const float c512 = std::pow(c64, 8.0F);
  return sun_over_pi_ * (0.5F * c16 + 2.0F * c64 + 24.0F * c512);
}

}  // namespace skyquilt::simulate
