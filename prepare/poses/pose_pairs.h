// Pairs of photos to match, chosen by poses that are known already.
#pragma once

#include <vector>

#include "core/geo/transform.h"
#include "prepare/poses/pairs.h"

namespace skyquilt::prepare::poses {

// All pairs of a small survey. Otherwise each photo with its `neighbors` nearest by position and direction, and links between groups. cam_from_world:
// of the photos, any scale and direction of the world. Directions count as much as positions that differ by as much as the scene is likely to be
// away, judged by the distances between photos. Throws base::Interrupted.
PhotoPairs PairsByPose(const std::vector<geo::Rigid3d>& cam_from_world, const PairRules& rules);

}  // namespace skyquilt::prepare::poses
