// Compares a trained block with the context on the same training pixels. A block that got too few steps, or whose training went wrong, may show its
// photos worse than the coarse field that it is meant to refine; then the context is what should be seen there.
#pragma once

#include "core/base/thread_pool.h"
#include "worker/rays/ray_source.h"
#include "worker/start/surface_interval.h"

namespace skyquilt::worker {

struct ContextComparison {
  double block_psnr_db = 0.0, context_psnr_db = 0.0;  // over the same pixels
  bool block_is_worse = false;                        // by more than 0.1 dB, and by more than three standard errors of the difference
};

// Renders some training pixels of the source with the block inside the context, and with the context alone. Builds the block's networks. Returns no
// difference when the source has no pixels with colours.
ContextComparison CompareWithContext(const RaySource& source, render::TrainedField& block, const LoadedContext& context, uint64_t seed,
                                     base::ThreadPool& threads);

}  // namespace skyquilt::worker
