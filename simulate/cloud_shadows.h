// Shadows of clouds that drift over a simulated place: a smooth pattern on the ground that takes a part of the sun's light, not of the sky's.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace skyquilt::simulate {

struct CloudShadowSpec {
  double stops = 0.0;        // by which the sun's light is less in a shadow; 0: no shadows
  double size_m = 150.0;     // wavelength of the largest shadows
  double penumbra_m = 40.0;  // width of their edges on the ground
  double speed_mps = 5.0;    // of the pattern, in a direction from the seed
  double cover = 0.4;        // share of the ground in shadow, half of the edges counted, 0 < cover < 1
};

class CloudShadows {
 public:
  // No shadows.
  CloudShadows() = default;
  // to_sun: unit, above the horizon.
  CloudShadows(const CloudShadowSpec& spec, const Eigen::Vector3f& to_sun, uint32_t seed);

  // The same clouds so many seconds later.
  CloudShadows At(double time_s) const;
  // Share of the sun's light that the clouds let through to a place in ENU metres, 2^-stops to 1; the same along every ray to the sun. Thread-safe.
  float SunShare(const Eigen::Vector3f& x_in_enu) const;

 private:
  float Cloud(float x, float y) const;

  bool on_ = false;
  CloudShadowSpec spec_;
  Eigen::Vector3f to_sun_ = Eigen::Vector3f::UnitZ();
  Eigen::Vector2f wind_ = Eigen::Vector2f::Zero();   // unit
  Eigen::Vector2f drift_ = Eigen::Vector2f::Zero();  // metres since time 0
  float threshold_ = 0.0F;                           // clouds are where the pattern is above
  uint32_t seed_ = 0;
};

}  // namespace skyquilt::simulate
