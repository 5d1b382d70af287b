// Outlines of buildings: the walls of all their parts together, as a reconstruction should find them, and the planes of their roofs.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "simulate/rectangle_union.h"
#include "simulate/simulated_building.h"

namespace skyquilt::simulate {

struct Outline {
  size_t first = 0;    // of its parts in the list of buildings
  size_t n_parts = 1;  // they follow each other
  size_t largest = 0;  // by plan area, in the list of buildings
  Ring walls;          // ENU, counter-clockwise
  std::vector<Ring> holes;
  Ring roof;  // walls and overhangs from above, counter-clockwise
  // The rectangle around the walls along the building's axes, length the longer.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double length_m = 0.0;
  double width_m = 0.0;
  double yaw_deg = 0.0;
  double area_m2 = 0.0;  // inside the walls, holes not counted
};

// Numbers outlines in the order of the list: sets Building::outline from Building::joined.
void NumberOutlines(std::vector<Building>& buildings);

// Of numbered buildings, in the order of their numbers. The sides of the parts of an outline are along common axes, and the parts are connected.
std::vector<Outline> FindOutlines(std::span<const Building> buildings);

struct RoofPlane3d {
  Eigen::Vector3d normal;  // unit, upwards; ENU
  double offset;           // normal . x
  // ENU z at a place.
  double HeightAt(const Eigen::Vector2d& at) const { return (offset - normal.head<2>().dot(at)) / normal.z(); }
};
// 1 of a flat roof, 2 of a gable, 4 of a hip.
std::vector<RoofPlane3d> RoofPlanes(const Building& part);
// ENU z of the roof at a place (east, north), continued beyond the walls.
double RoofHeight(const Building& part, const Eigen::Vector2d& at);

}  // namespace skyquilt::simulate
