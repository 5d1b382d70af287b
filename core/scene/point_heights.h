// Heights of the ground from sparse points, before any field is trained.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/scene/height_map.h"

namespace skyquilt::scene {

// Heights over the rectangle, with about four points per cell: the median of a cell's points, then the median of it and its neighbours, so that
// single wrong points do not count; cells without points are filled smoothly from their surroundings. points: at least one. ENU, metres.
HeightMap HeightsOfPoints(const std::vector<Eigen::Vector3d>& points, const Eigen::AlignedBox2d& area);

}  // namespace skyquilt::scene
