// Trees whose crowns touch the walls of houses, as they hide walls and roof edges from above in real towns.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/base/random.h"
#include "simulate/city_layout.h"

namespace skyquilt::simulate {

inline constexpr double kTouch_m = 0.03;  // between a crown and its wall

// Adds trees to `contents`, at most one per outline, at free walls of about a third of the houses, garages and sheds. Crowns touch their walls and
// enter neither walls nor roofs. detail: subdivisions of the crowns, as they will be drawn. `is_free`: whether a trunk may stand at a place.
void AddTreesAtWalls(int detail, const std::function<bool(const Eigen::Vector2d&)>& is_free, CityContents& contents, base::Random& random);

}  // namespace skyquilt::simulate
