// Where a field looks for matter when it starts: cells that cameras see, between the sparse points or in the bands where the context sees
// surfaces.
#pragma once

#include <vector>

#include "core/render/trained_field.h"
#include "core/scene/height_map.h"
#include "worker/ray_source.h"
#include "worker/surface_band.h"

namespace skyquilt::worker {

// Depth of a cell that has not been sampled yet: above every threshold for some dozens of samples.
constexpr float kStartTau = 0.1F;

// Cells in view of none of the photos become "never seen", and so do all cells above and below ground that fewer than min_views training photos
// show (unless that would leave none; empty surface: nothing is known of the ground). Tested per group of 4 x 4 x 4 cells, generously.
void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const scene::HeightMap& surface, int min_views,
                render::TrainedField& target, base::ThreadPool& threads);
// Every cell that may be seen is looked at: what fields without any knowledge of the survey do, for comparison.
void StartEverywhere(render::TrainedField& target);
// Leaves only cells between the sparse points: in each column of the ground from the lowest point near it to one cell above the highest point
// next to it. Columns without points of their own keep their whole height, and what lies outside the field's box stays as it is.
void StartFromPoints(const survey::Survey& survey, render::TrainedField& target);
// Leaves only cells in the bands where the context's light ends, as the tiles see them, and those of sparse points. Cells outside
// sleep until surfaces grow into them. Does nothing for a context without bands.
void StartFromBands(const RaySource& source, const survey::Survey& survey, const std::vector<Tile>& tiles, const LoadedContext& context,
                    render::TrainedField& target);

}  // namespace skyquilt::worker
