// Virtual cameras for the places that few photos see: above and around them, or, where photos look level, beside the photos that see them.
#pragma once

#include <vector>

#include "surface/views/coarse_depths.h"

namespace skyquilt::surface {

struct GapOptions {
  double voxel_m = 0.0;
  int min_views = 3;        // places seen by this many views or fewer get more
  double agl_m = 0.0;       // height above the ground, as of photos
  int64_t budget_rays = 0;  // pixels of all the virtual views together
  bool level = false;       // photos look level: from above one would see roofs, or the backs of walls
};

// First one camera straight above each weak place, the weakest first, then four oblique ones around each. None where there are no photo views.
// Of photos that look level: first one halfway between the photo that shows most of the place and the nearest one that looks the same way, then up to
// three as far to its other sides across the line of sight; without such a neighbour by half the distance to the place. They look at the place, are
// turned by 3 to 27 degrees and less where the photo sees the place at a flat angle, so that they see it from the same side, and stay within the
// heights of the photos. They are left out at and behind a surface that a photo shows in front of them but not in front of the photo beside them, and
// where they would look at the place through one.
// Same result for any number of threads. Throws base::Interrupted.
std::vector<ViewPose> PlanGapViews(const CoarseDepths& photos, const GapOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::surface
