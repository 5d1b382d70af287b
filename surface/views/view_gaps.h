// Virtual cameras above and around the places that few photos see.
#pragma once

#include <vector>

#include "surface/views/coarse_depths.h"

namespace skyquilt::surface {

struct GapOptions {
  double voxel_m = 0.0;
  int min_views = 3;        // places seen by this many views or fewer get more
  double agl_m = 0.0;       // height above the ground, as of photos
  int64_t budget_rays = 0;  // pixels of all the virtual views together
};

// First one camera straight above each weak place, the weakest first, then four oblique ones around each. None where there are no photo views.
// Same result for any number of threads. Throws base::Interrupted.
std::vector<ViewPose> PlanGapViews(const CoarseDepths& photos, const GapOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
