// Buildings of all kinds with difficult texts and unknown figures, and the frames in which they are written.
#pragma once

#include "buildings/building.h"
#include "core/scene/scene.h"
#include "surface/map_frame.h"

namespace skyquilt::buildings {

// Near Ulm, zone 32N. Without geo-reference: a local frame.
surface::MapFrame SampleFrame(bool georeferenced = true);
// A gable house, a hip house whose note and identity need quotes, a courtyard with a hole, and an L with many unknown figures.
BuildingSet SampleSet();

}  // namespace skyquilt::buildings
