// Flying height above the ground, per photo and per block. It decides the ground sampling distance and so how fine a block's field must be.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::partition {

// Metres above ground of every photo, > 0: Photo::agl_m where known, otherwise the camera's height above `ground_m`. A camera that is not above the
// ground gets its distance from `centre` instead, because its ground sampling distance depends on that.
std::vector<double> PhotoAltitudes(const survey::Survey& survey, const Eigen::Vector2d& centre, double ground_m);

// Metres: median over the photos taken above the rectangle, or over the five nearest photos when fewer than two were taken there. Photos taken
// elsewhere may see the block too, but their altitude is that of another block.
double BlockAltitude(const survey::Survey& survey, const std::vector<double>& photo_altitude_m, const Eigen::Vector2d& low,
                     const Eigen::Vector2d& high);

// What is odd about a block's height when it is not half to twice the flown one, and what follows from it; empty otherwise.
std::string AltitudeDoubt(const Block& block);

}  // namespace skyquilt::partition
