// Flying height above the ground, per photo and per block; of photos that look level, their distance to what they show. It decides the ground
// sampling distance where too few sparse points tell it (seen_gsd.h), and so how fine a block's field must be.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::partition {

struct PhotoAltitude {
  Eigen::Vector2d eye_enu = Eigen::Vector2d::Zero();  // the camera's place on the map, metres
  double agl_m = 0.0;                                 // its height above ground, or its distance to what it shows; > 0
};

// Of every training photo: Photo::agl_m where known, otherwise the camera's height above `ground_m`. A photo that looks level gets its median
// distance to the points that it observed, where they are enough; another camera that is not above the ground its distance from `centre`: ground
// sampling distances depend on that.
std::vector<PhotoAltitude> TrainingAltitudes(const survey::Survey& survey, const Eigen::Vector2d& centre, double ground_m);

// Metres: median over the photos taken above the rectangle, or over the five nearest photos when fewer than two were taken there. Photos taken
// elsewhere may see the block too, but their altitude is that of another block. There must be a photo.
double BlockAltitude(const std::vector<PhotoAltitude>& photos, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

// What is odd about a block's height when it is not half to twice the flown one, and what follows from it; empty otherwise.
std::string AltitudeDoubt(const Block& block);

}  // namespace skyquilt::partition
