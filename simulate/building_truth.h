// Writes what is known about the buildings of a simulated survey: every part, and the outlines that a reconstruction should find.
#pragma once

#include <filesystem>
#include <vector>

#include "core/geo/enu_frame.h"
#include "simulate/place_spec.h"
#include "simulate/simulated_building.h"

namespace skyquilt::simulate {

// truth/buildings.json in the survey's folder. Of numbered buildings (simulate/outline.h) on their ground.
void WriteBuildingTruth(const std::filesystem::path& folder, const std::vector<Building>& buildings, const PlaceSpec& place,
                        const geo::EnuFrame& frame);

}  // namespace skyquilt::simulate
