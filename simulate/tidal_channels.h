// Ground of a simulated tidal flat: sand banks with a branching network of channels. ENU metres, z = 0 at about the mean height of the sand.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace skyquilt::simulate {

class TidalChannels {
 public:
  TidalChannels(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double amplitude_m, uint32_t seed);

  // Height of the sand or the channel bed.
  double Height(double east, double north) const;
  double water_z_m() const { return -0.62; }

 private:
  struct Segment {  // a straight piece of channel
    Eigen::Vector2d a, b;
    double half_width_a, half_width_b;
    double depth_a, depth_b;
  };
  void Grow(Eigen::Vector2d from, double heading_rad, double half_width, double depth, double length, int order, uint32_t key);

  double amplitude_m_;
  uint32_t seed_;
  Eigen::Vector2d min_, max_;
  std::vector<Segment> reaches_;
};

}  // namespace skyquilt::simulate
