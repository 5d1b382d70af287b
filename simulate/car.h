// Cars, trucks and containers: parked ones are part of the static scene, moving ones have another position in every photo.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

enum class CarKind { kCar, kTruck, kContainer };

// Of trucks and containers.
inline constexpr double kTruckLength_m = 8.0, kTruckWidth_m = 2.5, kTruckHeight_m = 3.5;

struct Car {
  CarKind kind = CarKind::kCar;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // ENU metres
  double yaw_deg = 0.0;                                // counter-clockwise from east
  double ground_z_m = 0.0;
  Eigen::Vector2d ground_rise = Eigen::Vector2d::Zero();  // of the ground, per metre to the east and to the north; the car stands along it
  uint32_t seed = 0;
};

// A car that drives along a section of lane at constant speed. At the end of the section it starts again at its beginning.
struct MovingCar {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit
  double lane_length_m = 100.0;
  double offset_m = 0.0;  // along the lane at time 0
  double speed_mps = 8.0;
  uint32_t seed = 0;

  Car At(double time_s) const;  // the caller must set ground_z_m and ground_rise
};

// Adds the car's triangles, tagged with `index`.
void AddCar(const Car& car, uint32_t index, Mesh& mesh);

}  // namespace skyquilt::simulate
