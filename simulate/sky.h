// Light of the sun and the sky in a simulated place. Radiances are relative: a white surface that faces the sun has about 1.2 in linear light.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace skyquilt::simulate {

class Sky {
 public:
  // azimuth clockwise from north; clouds 0..1.
  Sky(double sun_azimuth_deg, double sun_elevation_deg, double intensity, double clouds, uint32_t seed);

  const Eigen::Vector3f& sun_direction() const { return sun_direction_; }      // towards the sun, unit
  const Eigen::Vector3f& sun_over_pi() const { return sun_over_pi_; }          // irradiance / pi on a surface that faces the sun
  const Eigen::Vector3f& ground_radiance() const { return ground_radiance_; }  // mean radiance of the ground
  // Radiance from a unit direction without the sun; below the horizon the mean of the ground.
  Eigen::Vector3f Radiance(const Eigen::Vector3f& direction) const;
  // What a photo shows in a direction where nothing stands: brighter on the sun's side.
  Eigen::Vector3f Seen(const Eigen::Vector3f& direction) const;
  // Extra radiance near the sun, as mirrored by a smooth wet surface.
  Eigen::Vector3f SunGlow(const Eigen::Vector3f& direction) const;

 private:
  Eigen::Vector3f sun_direction_;
  Eigen::Vector3f sun_over_pi_;
  Eigen::Vector3f ground_radiance_;
  float intensity_;
  float clouds_;
  uint32_t seed_;
};

}  // namespace skyquilt::simulate
