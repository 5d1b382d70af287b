// Where a field may look for matter when it starts: cells that cameras see, near the sparse points and in the bands where the context sees surfaces.
#pragma once

#include <vector>

#include "core/render/trained_field.h"
#include "worker/ray_source.h"
#include "worker/surface_band.h"

namespace skyquilt::worker {

// Cells in view of none of the photos become "never seen". Tested per group of 4 x 4 x 4 cells, generously.
void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, render::TrainedField& target,
                base::ThreadPool& threads);
// Leaves only cells in the bands where the context's light ends, as the photos' tiles see them. Does nothing for a context without bands.
void StartFromBands(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const LoadedContext& context,
                    render::TrainedField& target);
// Sparse points are matter.
void StartFromPoints(const survey::Survey& survey, render::TrainedField& target);

}  // namespace skyquilt::worker
