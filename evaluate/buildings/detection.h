// Completeness, correctness and quality of found buildings, per building and per area, by size.
#pragma once

#include <vector>

#include "evaluate/buildings/building_scores.h"
#include "evaluate/buildings/match_buildings.h"

namespace skyquilt::evaluate::buildings {

// All, then buildings of 10 to 50 m2, then larger ones. A pair is as large as its outline, an invented building as its footprint; invented ones below
// 10 m2 are in the first size. Areas do not depend on which building matches which: what was found over outlines that are not counted, or beyond the
// surveyed area, is cut off.
std::vector<BuildingDetection> ScoreDetection(const BuildingSet& found, const TrueBuildings& truth, const BuildingMatches& matches);

}  // namespace skyquilt::evaluate::buildings
