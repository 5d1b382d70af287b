// Finds places that too few training photos see. A single photo does not determine depth: a field fits it with density at any distance along the
// rays, which shows as floaters from every other viewpoint. Fields are therefore not trained on such places, and the background shows their coarse
// colours (core/scene/background.h).
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "core/scene/height_map.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"
#include "worker/start/point_ranges.h"

namespace skyquilt::worker {

// The tiles of the training photos among `photos` whose ground at least min_views of these photos see, including their own. The ground of a tile is
// where its centre ray meets `surface`; tiles that miss it are kept. All tiles when none has enough views, when `surface` is empty, and for min_views
// < 2. Where photos look level (`ranges` is not empty), the surface of a tile is in the middle of its range instead, not below the floor, and photos
// whose own ranges end before it do not see it. Throws base::Interrupted.
std::vector<Tile> TilesWithEnoughViews(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos,
                                       const scene::HeightMap& surface, const PointRanges& ranges, int min_views, base::ThreadPool& threads);

}  // namespace skyquilt::worker
