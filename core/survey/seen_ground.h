// The ground of a survey as its sparse points show it: which points tell where it is, and how far it reaches. For what is made before anything is
// trained. ENU, metres.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Finite positions of sparse points, only of those that at least three photos saw if these are enough.
std::vector<Eigen::Vector3d> SteadyPoints(const Survey& survey);

// The rectangle around the ground, level at ground_z, that the photos see at most kWidestView_deg from straight down; with enough points only where
// these are, without their outliers, and a little around. Empty when no photo looks down on the ground.
Eigen::AlignedBox2d SeenGround(const Survey& survey, const std::vector<Eigen::Vector3d>& points, double ground_z);
constexpr double kWidestView_deg = 60.0;

}  // namespace skyquilt::survey
