// Places photos by points that others have determined, for those without tags and those whose tags were wrong.
#pragma once

#include <cstdint>
#include <vector>

#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

// The entries of each photo.
std::vector<std::vector<uint32_t>> EntriesOfPhotos(const BundleProblem& bundle);
// The track of each entry.
std::vector<uint32_t> TrackOfEntries(const FeatureTracks& tracks);

// Gives a pose to photos that are not placed and see enough points: three of them give poses (RANSAC over P3P, Gao et al. 2003), the one with the
// most points within `threshold` units is taken and refined. Returns their number; points do not change.
size_t ResectPhotos(BundleProblem& bundle, double threshold);

// Moves a placed photo to where its entries within `threshold` units fit best, counted in pixels and anew at every step: RANSAC's are those that
// agree with three points. Points and lens do not change. Sets which of its entries agree and returns their number.
size_t RefineByPoints(BundleProblem& bundle, uint32_t photo, const std::vector<uint32_t>& entries, const std::vector<uint32_t>& track_of,
                      double threshold);

// Fewer agreeing observations do not make a pose (COLMAP registers photos from this number on).
constexpr size_t kLeastObservations = 30;

}  // namespace skyquilt::prepare::bundle
