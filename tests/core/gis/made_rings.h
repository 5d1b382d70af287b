// Polygons in UTM zone 31N as coordinates of GeoJSON.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

#include "core/geo/utm.h"

namespace skyquilt::gis {

using Ring = std::vector<Eigen::Vector2d>;  // easting and northing
using Rings = std::vector<Ring>;
inline const geo::UtmZone kMade31N = {31, true};

// more: further coordinates of each point, with a comma.
inline std::string InDegrees(const Rings& rings, const std::string& more = "") {
  std::string text;
  for (const Ring& ring : rings) {
    text += text.empty() ? "[" : ",[";
    for (size_t i = 0; i <= ring.size(); ++i) {
      const geo::Geodetic place = geo::GeodeticFromUtm(ring[i % ring.size()], 0.0, kMade31N);
      char point[80];
      std::snprintf(point, sizeof(point), "%s[%.12f,%.12f", i == 0 ? "" : ",", place.longitude_deg, place.latitude_deg);
      text += point + more + "]";
    }
    text += "]";
  }
  return "[" + text + "]";
}

}  // namespace skyquilt::gis
