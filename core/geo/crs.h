// Positions in any coordinate reference system that PROJ knows (EPSG codes, PROJ strings, WKT), as WGS84.
// Source: PROJ (proj_create_crs_to_crs to EPSG:4979). A system without heights keeps them: they count as ellipsoidal. Heights above a geoid need its
// grid (Debian: proj-data); without it they are kept as they are, as PROJ does.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

enum class AxisOrder {
  kEastNorth,  // x east or longitude, y north or latitude, whatever the system says: how most programs write files
  kAsDefined   // the order of the system's own definition: EPSG:4326 is latitude, longitude
};

class Crs {
 public:
  // `definition`: what PROJ understands, and "WGS84 UTM 32N" as OpenDroneMap writes it. Throws std::invalid_argument with PROJ's reason.
  explicit Crs(const std::string& definition, AxisOrder order = AxisOrder::kEastNorth);
  ~Crs();
  Crs(Crs&&) noexcept;
  Crs& operator=(Crs&&) noexcept;

  // x in the system's units. Throws std::invalid_argument when the position is outside what the system can express.
  Geodetic ToGeodetic(const Eigen::Vector3d& x_in_crs) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::geo
