// Photos of another place look like those of this one in a few dozen features by chance: enough for COLMAP's mapper to give them a pose (30 points),
// spread over many photos of which each has next to nothing in common with them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/survey/colmap_model.h"

namespace skyquilt::prepare::poses {

// Names of the photos, in name order, that are tied together by at least kLeastTied common points of two photos each, the largest group first.
std::vector<std::vector<std::string>> TiedPhotos(const survey::ColmapModel& model);
// Names, in name order, of the photos outside of the largest group that is tied together by at least kLeastTied common points of two photos each. Of
// a model without points nothing can be said: then there are none.
std::vector<std::string> LoosePhotos(const survey::ColmapModel& model);
// Takes these photos out of the model, and the points that fewer than two photos are left to see.
void RemovePhotos(const std::function<bool(const survey::ColmapImage&)>& removed, survey::ColmapModel& model);
// Takes the poses from loose photos, and the observations of what is gone. Returns the names of the photos that lost their pose, in name order.
std::vector<std::string> RemoveLoosePhotos(survey::ColmapModel& model, survey::ColmapObservations& observations);
// Photos of another place have up to 5 by chance (`bench poses`), neighbours of a flight hundreds.
constexpr size_t kLeastTied = 10;

}  // namespace skyquilt::prepare::poses
