// Which photos of a survey may show which places of a map: the ones that look down on them most steeply, and then the nearest.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/survey.h"

namespace skyquilt::products {

// How badly a camera at `eye` shows a place: the squared tangent of the angle from straight down, and a twentieth of the squared distance in units of
// typical_height_m. Infinite when the camera is not above the place, or sees it too obliquely (tan^2 > kMostOblique, 65 degrees).
double ViewCost(const Eigen::Vector3d& place_enu, const Eigen::Vector3d& eye_enu, double typical_height_m);
constexpr double kMostOblique = 4.6;

// Photos (1) that together see the places well and as evenly as possible, and have at most max_pixels pixels at full size, so that reading them does
// not take too long. All of them if they do. One at least.
std::vector<char> ChooseFewPhotos(const survey::Survey& survey, std::span<const Eigen::Vector3d> places_enu, double max_pixels,
                                  double typical_height_m, base::ThreadPool& threads);

}  // namespace skyquilt::products
