// How far the roofs of varied towns reach beyond the walls. Were it the same everywhere, a method could learn it from one building and know the walls
// of all others.
#pragma once

#include <vector>

#include "simulate/city_layout.h"
#include "simulate/simulated_building.h"

namespace skyquilt::simulate {

inline constexpr double kSmallestOverhang_m = 0.2, kLargestOverhang_m = 0.8;
inline constexpr double kSmallestShedOverhang_m = 0.1, kLargestShedOverhang_m = 0.4;  // of sheds and garages
inline constexpr double kBetweenRoofs_m = 0.3;                                        // room that overhangs leave to other outlines

// Gives every outline its own overhang, the same for all its parts: uniform between these limits, or up to where the room to its neighbours ends.
// It depends on the building's own seed and the room only, so that walls and all else stay as they are. Buildings must be numbered (outline.h).
void DrawOverhangs(std::vector<Building>& buildings);

// Removes trees whose crowns would touch an overhang. detail: subdivisions of the crowns, as they will be drawn.
void RemoveTreesAtRoofs(int detail, CityContents& contents);

}  // namespace skyquilt::simulate
