// How far away photos saw what they show, by the sparse points that they observed. Where photos look down this is their height above ground; for
// those that look level, along a facade or in a room, their height says nothing about it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::survey {

// Fewer points do not tell a distance.
constexpr size_t kFewestSeenPoints = 20;

// Whether the photo's view is within 17 degrees of level.
bool LooksLevel(const Photo& photo);

// Metres by which a place's pixel size follows from the focal length: along the optical axis, as on a plane square to it; for fisheye lenses, whose
// pixels are alike by angle, the straight distance. Not above 0 for places behind the camera.
double ViewingDistance(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const Eigen::Vector3d& x_in_enu);

struct SeenDistance {
  double median_m = 0.0;  // ViewingDistance, > 0
  double far_m = 0.0;     // straight distance within which 95 % of the points are
};

// Per photo; nothing for photos that do not look level, that are held out, or that observed fewer than kFewestSeenPoints points.
std::vector<std::optional<SeenDistance>> DistancesOfLevelPhotos(const Survey& survey);

}  // namespace skyquilt::survey
