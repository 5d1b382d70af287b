// From where to look at something.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "tour/format/tour.h"
#include "tour/ways/heights.h"

namespace skyquilt::tour {

// Something to look at: an upright cylinder.
struct Subject {
  Eigen::Vector3d foot_enu;
  double radius_m = 1.0, height_m = 0.0;
};

// A place obliquely above it, free and at least two metres from all that is solid, from where nothing hides it; turned so that the survey is behind
// it as far as possible. Where there is no such place: from right above. heights: null when nothing is known to be in the way.
Pose ViewOf(const Subject& subject, const Eigen::Vector2d& middle_of_survey, const Heights* heights);

// All of a box from the south, obliquely, and higher than all that is in it.
Pose Overview(const Eigen::AlignedBox3d& box_enu, double ground_m);

}  // namespace skyquilt::tour
