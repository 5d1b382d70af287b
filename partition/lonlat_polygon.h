// Outlines of blocks as polygons that GIS programs draw correctly everywhere on Earth, as RFC 7946 requires: longitude, latitude, counter-clockwise,
// split where they cross the date line.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace skyquilt::partition {

using Ring = std::vector<Eigen::Vector2d>;  // longitude, latitude in degrees; closed: first == last

struct LonLatOutline {
  std::vector<Ring> parts;  // one, or several where the outline crosses +-180 degrees (RFC 7946, 3.1.9)
  double west_deg = 0.0;    // RFC 7946, 5.2: west > east when the outline crosses the date line; -180, 180 around a pole
  double south_deg = 0.0;
  double east_deg = 0.0;
  double north_deg = 0.0;
};

// corners: longitude, latitude in degrees; counter-clockwise as seen from above, at least three, not closed, neighbours less than 180 degrees of
// longitude apart. An outline around a pole becomes the area between the outline and the map edge at the pole.
LonLatOutline MakeOutline(const std::vector<Eigen::Vector2d>& corners);

}  // namespace skyquilt::partition
