// Which photos of rigs are matched: shots near to each other, and of these the photos that look the same way.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "prepare/input/photo_files.h"
#include "prepare/poses/pairs.h"

namespace skyquilt::prepare::poses {

// Pairs of all photos that rigs took: with those of the `neighbors` nearest shots by GPS, where all shots have a position, else of those as many
// before and after by time or name; of two shots those whose axes are at most kMostApart_deg from each other by the gimbal tags (all where these have
// no yaw), and within a shot likewise by the rig. A chain of shots that are nearest to each other joins all that have a position.
PhotoPairs PairsOfRigs(const std::vector<input::PhotoFile>& photos, size_t neighbors);
constexpr double kMostApart_deg = 60.0;

// Whether PairsOfRigs is all that is needed: every photo is of a rig and has a position.
bool RigsTellAllPairs(const std::vector<input::PhotoFile>& photos);

}  // namespace skyquilt::prepare::poses
