// The walls of a building as one sees them: faces in one plane that stand side by side are one wall.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// Places on it are given in metres to the right of and below its upper left corner, as seen by one who looks at it from outside.
struct WallSide {
  Eigen::Vector3d normal;    // level, length 1, out of the building
  Eigen::Vector3d right;     // level, length 1
  Eigen::Vector3d top_left;  // ENU, of the rectangle around the wall
  double width_m = 0.0, height_m = 0.0;
  std::vector<std::vector<Eigen::Vector2d>> rings;  // of its faces, holes among them

  Eigen::Vector3d At(const Eigen::Vector2d& place) const { return top_left + place.x() * right - place.y() * Eigen::Vector3d::UnitZ(); }
  bool Contains(const Eigen::Vector2d& place) const;
};
// In the order of their first faces.
std::vector<WallSide> WallSidesOf(const Solid& solid);

}  // namespace skyquilt::buildings
