// The adjustment of a bundle whose photos are placed roughly: triangulate, choose observations, adjust, in three rounds that ask for more and more
// agreement.
#pragma once

#include <string>

#include "core/base/thread_pool.h"
#include "prepare/bundle/bundle_problem.h"

namespace skyquilt::prepare::bundle {

// Largest distance between a feature and its point in the last round, pixels of a photo of 1600 pixels width; as in the seeding.
constexpr double kFinalThreshold = 4.0;

// Points are triangulated anew at the end. label: of the progress bar. False when no solution is found; the bundle is then that of the round before.
// Throws base::Interrupted.
bool AdjustInRounds(BundleProblem& bundle, const std::string& label, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::bundle
