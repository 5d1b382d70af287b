// Points from the observations of tracks, some of which are wrong.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/thread_pool.h"
#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

// Places the point of one track and marks the entries that agree with it. Tries the point it has, and the meetings of pairs of rays; the one with the
// most entries within `threshold` (units, see BundleLens) is refined by Gauss-Newton. No point, when fewer than two entries agree or their rays meet
// at less than kLeastAngle_deg.
void TriangulateTrack(BundleProblem& bundle, uint32_t track, double threshold);
// The same for several tracks, in parallel.
void Triangulate(BundleProblem& bundle, std::span<const uint32_t> tracks, double threshold, base::ThreadPool& threads);
void TriangulateAll(BundleProblem& bundle, double threshold, base::ThreadPool& threads);

constexpr double kLeastAngle_deg = 1.5;

// Points to begin with, while directions are off by degrees and rays meet anywhere: the mean of the places that are `height_m` below the cameras on
// the rays of the track. All entries of placed photos agree.
void PlaceOnGround(BundleProblem& bundle, std::span<const uint32_t> tracks, double height_m);

}  // namespace skyquilt::prepare::bundle
