// Places that too few training photos see. A single photo says nothing about depth: what is learned from it alone hangs somewhere along its
// rays and comes out as shards from any other place. Fields learn nothing there; the background shows its coarse colours.
#pragma once

#include <vector>

#include "core/scene/height_map.h"
#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Training photos among `photos` whose frame shows the ball of radius_m around a place; counting stops at `enough`.
int CountViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const Eigen::Vector3d& x_in_enu,
               double radius_m, int enough);

// The training tiles of the photos whose ground at least min_views training photos see, their own included. All tiles when that leaves none,
// without a surface, and for min_views < 2.
std::vector<Tile> TilesWithEnoughViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                       const scene::HeightMap& surface, int min_views);

}  // namespace skyquilt::worker
