// Where a field may look for matter when it starts: cells that cameras see, near the sparse points and where the context has density.
#pragma once

#include <vector>

#include "core/render/trained_field.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Cells in view of none of the photos become "never seen". Tested per group of 4 x 4 x 4 cells, generously.
void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, render::TrainedField& target,
                base::ThreadPool& threads);
// Leaves only cells near sparse points or context density; everything seen stays when neither exists there.
void StartFromContext(const survey::Survey& survey, const render::TrainedField& context, render::TrainedField& target, base::ThreadPool& threads);

}  // namespace skyquilt::worker
