// People who walk on pavements: each has another place in every photo. And street lamps, which are part of the static scene.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "simulate/surface.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

struct Person {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // ENU metres
  double yaw_deg = 0.0;                                // of the way they walk, counter-clockwise from east
  double ground_z_m = 0.0;
  uint32_t seed = 0;
};

// Someone who walks along a pavement at constant speed, and at its end begins again.
struct Walker {
  Eigen::Vector2d start = Eigen::Vector2d::Zero();
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  // unit
  double way_m = 100.0;
  double offset_m = 0.0;  // along the way at time 0
  double speed_mps = 1.4;
  uint32_t seed = 0;

  Person At(double time_s) const;  // the caller must set ground_z_m
};

// Adds the person's triangles, tagged with `index`: about 1.7 m high, 0.5 m across the shoulders.
void AddPerson(const Person& person, uint32_t index, Mesh& mesh);
Surface PersonSurface(const Person& person, const Hit& hit);

struct Lamp {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // of the post, ENU metres
  double yaw_deg = 0.0;                                // direction of the arm
  double ground_z_m = 0.0;
  double height_m = 7.0;
};

// A post of 0.16 m with an arm of 1.4 m and a head above the road.
void AddLamp(const Lamp& lamp, uint32_t index, Mesh& mesh);
Surface LampSurface(const Hit& hit);

}  // namespace skyquilt::simulate
