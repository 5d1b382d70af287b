// Positions in any coordinate reference system that PROJ knows (EPSG codes, PROJ strings, WKT), as WGS84.
// Source: PROJ (to EPSG:4979). A system without heights keeps them: they count as ellipsoidal and metric, whatever its horizontal unit. Heights above
// a geoid need its grid (Debian's proj-data has that of EGM96). Where PROJ has none it returns such heights unchanged (EPSG:9518, most national
// systems) and only says so in the name of the operation; here that is an error.
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

enum class CrsHeights {
  kNone,         // the system has two axes
  kEllipsoidal,  // above the ellipsoid of its datum, or geocentric
  kGravity       // above a geoid or a sea level
};

struct CrsPart {
  std::string name;     // "NAVD88 height (ftUS)"; "unknown" for PROJ strings; empty: the system has no such part
  std::string unit;     // of its first axis: "metre", "US survey foot", "degree"
  double unit_m = 0.0;  // metres per unit; 0: not a length
};

class Crs {
 public:
  // `definition`: what PROJ understands, and "WGS84 UTM 32N" as OpenDroneMap writes it. Throws std::invalid_argument with PROJ's reason.
  explicit Crs(const std::string& definition, AxisOrder order = AxisOrder::kEastNorth);
  ~Crs();
  Crs(Crs&&) noexcept;
  Crs& operator=(Crs&&) noexcept;

  const std::string& name() const;
  const CrsPart& horizontal() const;  // of a geocentric system: all of it
  const CrsPart& vertical() const;    // for ellipsoidal heights its name is "ellipsoid"
  CrsHeights heights() const;
  bool IsGeographic() const;  // x and y are longitude and latitude
  // The same system without its heights. Throws std::invalid_argument for a geocentric system.
  Crs WithoutHeights() const;

  // x in the system's units. Throws std::invalid_argument when the position is outside what the system can express, or when its heights cannot be
  // made ellipsoidal.
  Geodetic ToGeodetic(const Eigen::Vector3d& x_in_crs) const;
  // The inverse; throws std::invalid_argument likewise.
  Eigen::Vector3d FromGeodetic(const Geodetic& position) const;
  // Whether PROJ knows no exact way from the system's datum to WGS84 at this position: it may be off by metres, with old datums by hundreds.
  bool IsDatumGuessed(const Eigen::Vector3d& x_in_crs) const;

 private:
  struct Impl;
  explicit Crs(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::geo
