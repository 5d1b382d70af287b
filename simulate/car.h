// Cars: parked ones belong to the scenery, moving ones have a place per photo.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulate/mesh.h"

namespace skyquilt::simulate {

struct Car {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // ENU metres
  double yaw_deg = 0.0;                                // counter-clockwise from east
  double ground_z_m = 0.0;
  uint32_t seed = 0;
};

// A section of lane driven at constant speed; past its end the car enters again at the start.
struct MovingCar {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit
  double lane_length_m = 100.0;
  double offset_m = 0.0;  // along the lane at time 0
  double speed_mps = 8.0;
  uint32_t seed = 0;

  Car At(double time_s) const;  // ground_z_m is left 0
};

void AddCar(const Car& car, uint32_t index, Mesh& mesh);

}  // namespace skyquilt::simulate
