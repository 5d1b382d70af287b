// Generators of positions for the property tests; the seed is fixed unless RC_PARAMS is set.
#pragma once

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/geo/geodetic.h"

namespace skyquilt::geo {

inline const bool kSeedIsFixed = setenv("RC_PARAMS", "seed=20260131 max_success=300", 0) == 0;

inline rc::Gen<double> Between(double low, double high) {
  constexpr int kSteps = 1 << 30;
  // With RapidCheck's default size, early cases would only use the low end of the range.
  const auto step = rc::gen::resize(rc::kNominalSize, rc::gen::inRange(0, kSteps + 1));
  return rc::gen::map(step, [low, high](int i) { return low + (high - low) * (static_cast<double>(i) / kSteps); });
}

// Anywhere on Earth, from a mine to above the highest mountain; poles, date line and equator are frequent.
inline rc::Gen<Geodetic> AnyPosition() {
  const auto latitude = rc::gen::oneOf(Between(-90.0, 90.0), rc::gen::element(-90.0, -89.999999, -84.0, -1e-9, 0.0, 84.0, 89.999999, 90.0));
  const auto longitude = rc::gen::oneOf(Between(-180.0, 180.0), rc::gen::element(-180.0, -179.9999999, -3.0, 0.0, 179.9999999, 180.0));
  const auto height = rc::gen::oneOf(Between(-500.0, 9000.0), rc::gen::element(-430.0, 0.0, 9000.0));
  return rc::gen::construct<Geodetic>(latitude, longitude, height);
}

// Distance on the ground between nearby positions, metres, also across the date line.
inline double GroundDistanceMetres(const Geodetic& a, const Geodetic& b) {
  constexpr double kMetresPerDegree = 111320.0;
  const double north = (a.latitude_deg - b.latitude_deg) * kMetresPerDegree;
  const double east =
      std::remainder(a.longitude_deg - b.longitude_deg, 360.0) * kMetresPerDegree * std::cos(a.latitude_deg * std::numbers::pi / 180.0);
  return std::hypot(north, east);
}

}  // namespace skyquilt::geo
