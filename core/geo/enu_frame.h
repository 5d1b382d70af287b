// The local frame in which a whole survey is processed: x east, y north, z up, metres, about a stored WGS84 origin.
// Double precision; valid anywhere on Earth, including the poles and the date line.
// Source: GeographicLib::LocalCartesian (Karney).
#pragma once

#include <Eigen/Core>
#include <memory>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

class EnuFrame {
 public:
  // Throws std::invalid_argument if the origin is not valid.
  explicit EnuFrame(const Geodetic& origin);
  ~EnuFrame();
  EnuFrame(EnuFrame&&) noexcept;
  EnuFrame& operator=(EnuFrame&&) noexcept;

  const Geodetic& origin() const { return origin_; }
  Eigen::Vector3d EnuFromGeodetic(const Geodetic& position) const;
  Geodetic GeodeticFromEnu(const Eigen::Vector3d& x_in_enu) const;

 private:
  Geodetic origin_;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::geo
