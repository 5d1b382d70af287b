// Walls in the sparse points of a survey: vertical planes, found by random sampling (RANSAC, Fischler and Bolles 1981) helped by the survey's
// dominant directions. For pictures straight on a wall, made without a mesh. ENU, metres.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::products {

// A rectangle on a vertical plane.
struct Wall {
  Eigen::Vector3d middle_enu = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_enu = Eigen::Vector3d::UnitX();  // level, length 1, towards the photos that see it
  double width_m = 0.0, height_m = 0.0;                   // of its points, without outliers, and a little around
  size_t points = 0;                                      // that lie on it
};

constexpr size_t kMostWalls = 4;

// The largest by area first; those below a tenth of the largest are left out. A wall has at least 30 points within 1 % of the distance from which
// photos see points, more than there are as far again beside it, and no gap of a fifth of that distance. Deterministic.
std::vector<Wall> FindWalls(const survey::Survey& survey, size_t most = kMostWalls);

// The distance from which training photos see sparse points, median; NaN without points or photos.
double ViewingDistance(const survey::Survey& survey);

}  // namespace skyquilt::products
