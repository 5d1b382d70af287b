// The ground of a survey as its sparse points show it: where it is, and how high. For pictures made before anything is trained. ENU, metres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/scene/height_map.h"
#include "core/survey/survey.h"

namespace skyquilt::products {

// Finite positions of sparse points, only of those that at least three photos saw if these are enough.
std::vector<Eigen::Vector3d> SteadyPoints(const survey::Survey& survey);

// The rectangle around the ground, level at ground_z, that the photos see at most kWidestView_deg from straight down; with enough points only where
// these are, without their outliers, and a little around. Empty when no photo looks down on the ground.
Eigen::AlignedBox2d SeenGround(const survey::Survey& survey, const std::vector<Eigen::Vector3d>& points, double ground_z);
constexpr double kWidestView_deg = 60.0;

// Heights over the rectangle, with about four points per cell: the median of a cell's points, then the median of it and its neighbours, so that
// single wrong points do not count; cells without points are filled smoothly from their surroundings. points: at least one.
scene::HeightMap HeightsOfPoints(const std::vector<Eigen::Vector3d>& points, const Eigen::AlignedBox2d& area);

}  // namespace skyquilt::products
