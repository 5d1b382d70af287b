// The plane through a few surface points, and the level or vertical plane that it nearly is. Any frame whose z is up, metres.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace skyquilt::worker {

struct Plane {
  Eigen::Vector3d point, normal;  // normal: unit, of either sign
};

constexpr size_t kFewestPlanePoints = 4;

// Least squares. Nothing when the points do not tell: fewer than kFewestPlanePoints, equal, on a line, or scattered as much across as along.
std::optional<Plane> FitPlane(const std::vector<Eigen::Vector3d>& points);
// Nothing for planes that are tilted, such as pitched roofs. yaw_deg: the direction of buildings there, counter-clockwise from east; a wall that
// nearly follows it, or stands at a right angle to it, follows it exactly.
std::optional<Plane> UprightPlane(const Plane& plane, std::optional<double> yaw_deg = std::nullopt);

}  // namespace skyquilt::worker
