// Which pairs of photos are matched: by their tags where these are of use, by their looks where they are not.
#pragma once

#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/feature_store.h"
#include "prepare/poses/pairs.h"
#include "prepare/poses/pose_options.h"

namespace skyquilt::prepare::poses {

// All pairs of a small survey. Otherwise photos with a place are paired in space (PairsInSpace), those without with the photos that look most like
// them and with their neighbours in name order; pairs between groups make the whole survey one. The same photos and seed give the same pairs. Throws
// base::Interrupted, and base::InputError for a damaged database.
PhotoPairs ChoosePairs(const std::vector<input::PhotoFile>& photos, const PairRules& rules, uint64_t seed, FeatureStore& features,
                       base::ThreadPool& threads);

}  // namespace skyquilt::prepare::poses
