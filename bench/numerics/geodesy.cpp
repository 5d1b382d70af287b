#include "bench/numerics/geodesy.h"

#include <cmath>
#include <numbers>

#include "core/geo/enu_frame.h"
#include "core/geo/utm.h"

namespace skyquilt::bench {
namespace {

// The value goes through memory, because g++ 12 removes both conversions where it vectorises several of them.
double InFloat(double value) {
  volatile float rounded = static_cast<float>(value);
  return static_cast<double>(rounded);
}

}  // namespace

Vector3L EcefOf(const geo::Geodetic& position) {
  constexpr long double kSemiMajor_m = 6378137.0L;
  constexpr long double kFlattening = 1.0L / 298.257223563L;
  constexpr long double kEccentricity2 = kFlattening * (2.0L - kFlattening);
  constexpr long double kRadians = std::numbers::pi_v<long double> / 180.0L;
  const long double latitude = static_cast<long double>(position.latitude_deg) * kRadians;
  const long double longitude = static_cast<long double>(position.longitude_deg) * kRadians;
  const auto height = static_cast<long double>(position.height_m);
  const long double normal = kSemiMajor_m / std::sqrt(1.0L - kEccentricity2 * std::sin(latitude) * std::sin(latitude));
  return {(normal + height) * std::cos(latitude) * std::cos(longitude), (normal + height) * std::cos(latitude) * std::sin(longitude),
          (normal * (1.0L - kEccentricity2) + height) * std::sin(latitude)};
}

double DistanceMetres(const geo::Geodetic& a, const geo::Geodetic& b) {
  return static_cast<double>((EcefOf(a) - EcefOf(b)).norm());
}

const std::vector<NaiveFrame>& NaiveFrames() {
  static const std::vector<NaiveFrame> frames = {NaiveFrame::kDegrees, NaiveFrame::kEcef, NaiveFrame::kUtm, NaiveFrame::kEnu};
  return frames;
}

std::string NaiveName(NaiveFrame frame) {
  switch (frame) {
    case NaiveFrame::kDegrees:
      return "float degrees";
    case NaiveFrame::kEcef:
      return "float ECEF";
    case NaiveFrame::kUtm:
      return "float UTM/UPS";
    case NaiveFrame::kEnu:
      return "float survey-wide ENU";
  }
  return "";
}

double NaiveErrorMetres(NaiveFrame frame, const geo::Geodetic& origin, const geo::Geodetic& position) {
  switch (frame) {
    case NaiveFrame::kDegrees:
      return DistanceMetres(position, {InFloat(position.latitude_deg), InFloat(position.longitude_deg), InFloat(position.height_m)});
    case NaiveFrame::kEcef: {
      const Vector3L exact = EcefOf(position);
      return static_cast<double>((exact.cast<float>().cast<long double>() - exact).norm());
    }
    case NaiveFrame::kUtm: {
      const Eigen::Vector2d plane = geo::UtmFromGeodetic(position, geo::UtmZoneOf(origin));
      const double up = position.height_m - InFloat(position.height_m);
      return std::hypot((plane.cast<float>().cast<double>() - plane).norm(), up);
    }
    case NaiveFrame::kEnu: {
      const Eigen::Vector3d exact = geo::EnuFrame(origin).EnuFromGeodetic(position);
      return (exact.cast<float>().cast<double>() - exact).norm();
    }
  }
  return 0.0;
}

}  // namespace skyquilt::bench
