// The frames in which the Python module takes and gives places, and the ways between them and a scene's own.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>

#include "core/base/thread_pool.h"
#include "core/geo/enu_frame.h"
#include "core/geo/geodetic.h"
#include "core/geo/utm.h"

namespace skyquilt::python {

enum class Frame {
  kEnu,    // the survey's: east, north, up, metres from the origin
  kUtm,    // easting, northing, height, metres; the zone of the origin (UPS near the poles)
  kWgs84,  // longitude, latitude, degrees, and height, metres
};
// "enu", "utm", "wgs84". Throws base::UsageError that lists the choices.
Frame FrameNamed(const std::string& name);

// Heights of UTM and WGS84 are the survey's, which computations take for ellipsoidal (docs/coordinates.md). Thread-safe.
class Places {
 public:
  Places(const geo::Geodetic& origin, bool georeferenced);

  // Nothing without geo-reference.
  const std::optional<geo::UtmZone>& zone() const { return zone_; }
  // Throw base::UsageError for another frame than ENU without geo-reference. Coordinates that are not finite, or not on Earth, become NaN.
  void ToEnu(Frame from, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out, base::ThreadPool& threads) const;
  void FromEnu(Frame to, std::span<const Eigen::Vector3d> in, std::span<Eigen::Vector3d> out, base::ThreadPool& threads) const;
  // Easting and northing of a place; its height does not matter. Throws std::invalid_argument for a place that is not on Earth.
  Eigen::Vector2d EastingNorthing(Frame from, const Eigen::Vector2d& place) const;
  // Throws base::UsageError when places cannot be in this frame.
  void Require(Frame frame) const;

 private:
  Eigen::Vector3d EnuOf(Frame from, const Eigen::Vector3d& x) const;
  Eigen::Vector3d FrameOf(Frame to, const Eigen::Vector3d& x_in_enu) const;

  std::optional<geo::EnuFrame> enu_;
  std::optional<geo::UtmZone> zone_;
};

}  // namespace skyquilt::python
