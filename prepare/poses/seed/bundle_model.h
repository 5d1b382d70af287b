// A bundle of the photos of a database: its tracks, and what is found as a COLMAP model.
#pragma once

#include "core/survey/colmap_model.h"
#include "prepare/bundle/bundle_problem.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::prepare::poses {

// Gives a bundle with the photos of the input, in its order, the tracks of all its matches. No track has a point yet.
void FillTracks(const SeedInput& input, bundle::BundleProblem& bundle);

// Adds the placed photos, the lenses and the points that enough photos see to an empty model, with the observations that agree. Photos and lenses of
// the bundle are those of the input, in its order. Points are black.
void ModelOfBundle(const SeedInput& input, const bundle::BundleProblem& bundle, survey::ColmapModel* model, survey::ColmapObservations* observations);

}  // namespace skyquilt::prepare::poses
