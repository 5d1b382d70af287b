// Outlines on the globe as RFC 7946 wants them: rings in longitude, latitude, counter-clockwise, split where they cross the date line.
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

// `corners` run counter-clockwise as seen from above, not closed, neighbours less than 180 degrees of longitude apart. An outline around a pole
// becomes the cap from its lowest ring up to the pole's edge of the map.
LonLatOutline MakeOutline(const std::vector<Eigen::Vector2d>& corners);

}  // namespace skyquilt::partition
