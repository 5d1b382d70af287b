// Height of flight above the ground, per photo and per block.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::partition {

// Metres above ground of every photo: Photo::agl_m where known, otherwise its height over `ground_m`; always > 0. A camera that is not above
// the ground at all gets its distance from `centre` instead, which is what its ground sampling distance depends on.
std::vector<double> PhotoAltitudes(const survey::Survey& survey, const Eigen::Vector2d& centre, double ground_m);

// Median over the photos taken above the rectangle; over the five nearest when fewer than two were.
// Photos taken elsewhere see the block too, but from the altitude of their own block.
double BlockAltitude(const survey::Survey& survey, const std::vector<double>& photo_altitude_m, const Eigen::Vector2d& low,
                     const Eigen::Vector2d& high);

}  // namespace skyquilt::partition
