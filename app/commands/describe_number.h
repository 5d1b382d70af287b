// Numbers as `skyquilt info` shows them: rounded, null when not finite.
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/geo/geodetic.h"

namespace skyquilt::app {

// To `digits` decimals.
inline nlohmann::ordered_json Round(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  const double scale = std::pow(10.0, digits);
  return std::round(value * scale) / scale;
}

// To three significant digits, so that a small value does not become 0, which means exactly known.
inline nlohmann::ordered_json RoundSignificant(double value) {
  if (!std::isfinite(value) || value == 0.0) return Round(value, 0);
  return Round(value, 2 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
}

inline nlohmann::ordered_json DescribeOrigin(const geo::Geodetic& origin) {
  return {{"latitude_deg", origin.latitude_deg}, {"longitude_deg", origin.longitude_deg}, {"height_m", origin.height_m}};
}

}  // namespace skyquilt::app
