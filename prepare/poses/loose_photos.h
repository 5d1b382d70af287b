// Photos of another place look like those of this one in a few dozen features by chance: enough for COLMAP's mapper to give them a pose (30 points),
// spread over many photos of which each has next to nothing in common with them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/survey/colmap_model.h"

namespace skyquilt::prepare {

// Takes the poses from all photos but the largest group that is tied together by at least kLeastTied common points of two photos each. Points that
// fewer than two photos are left to see go too, and so do the observations of what is gone. Returns the names of the photos that lost their pose, in
// name order; of a model without points nothing can be said, so that none do.
std::vector<std::string> RemoveLoosePhotos(survey::ColmapModel& model, survey::ColmapObservations& observations);
// Photos of another place have up to 5 by chance (`bench poses`), neighbours of a flight hundreds.
constexpr size_t kLeastTied = 10;

}  // namespace skyquilt::prepare
