// A bundle as a COLMAP model.
#pragma once

#include "core/survey/colmap_model.h"
#include "prepare/bundle/bundle_problem.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::prepare::poses {

// Adds the placed photos, the lenses and the points that enough photos see to an empty model, with the observations that agree. Photos and lenses of
// the bundle are those of the input, in its order. Points are black.
void ModelOfBundle(const SeedInput& input, const bundle::BundleProblem& bundle, survey::ColmapModel* model, survey::ColmapObservations* observations);

}  // namespace skyquilt::prepare::poses
