// Chooses the cells that are occupied, and therefore sampled, when training of a field starts. Fewer cells mean fewer samples per ray and fewer
// floaters. Only cells that cameras see are chosen: for the context those between the sparse points, for blocks those near surfaces of the context.
#pragma once

#include <vector>

#include "core/render/trained_field.h"
#include "core/scene/height_map.h"
#include "worker/rays/ray_source.h"
#include "worker/start/point_ranges.h"
#include "worker/start/surface_interval.h"

namespace skyquilt::worker {

// Initial tau of an occupied cell: it stays above the occupancy threshold for some dozens of samples even when they find no density.
constexpr float kStartTau = 0.1F;

// Marks cells as never seen (negative tau): those that no training photo sees, and all cells above and below ground that fewer than min_views
// training photos see. The second rule is not applied when it would leave no cells, or when `surface` is empty. Tested for groups of 4 x 4 x 4 cells,
// enlarged to be on the safe side. Where photos look level (`ranges` is not empty), there is no second rule: all cells that fewer than min_views
// photos see between the ends of their ranges are marked.
void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const scene::HeightMap& surface,
                const PointRanges& ranges, int min_views, render::TrainedField& target, base::ThreadPool& threads);
// Keeps all cells that are not marked as never seen, for comparison.
void StartEverywhere(render::TrainedField& target);
// Keeps only cells at heights where there are sparse points: in every column of the ground from one cell below the lowest point in its neighbourhood
// to one cell above the highest point of the column and its direct neighbours, or of the neighbourhood when the column has no points. Columns without
// points in their neighbourhood keep all cells. Cells outside the field's uncontracted box are not changed.
void StartFromPoints(const survey::Survey& survey, render::TrainedField& target);
// The same where photos look level: keeps only the cells that rays of the given tiles meet inside their ranges, and none along rays that show sky.
void StartFromRanges(const RaySource& source, const PointRanges& ranges, const std::vector<Tile>& tiles, render::TrainedField& target);
// Keeps only cells near the surfaces that the context shows in the given tiles (surface_interval.h), and cells with sparse points; none
// for tiles that show only sky. Other cells are free until surfaces grow into them. Does nothing when the context has no bands.
void StartFromSurfaces(const RaySource& source, const PointRanges& ranges, const survey::Survey& survey, const std::vector<Tile>& tiles,
                       const LoadedContext& context, render::TrainedField& target);

}  // namespace skyquilt::worker
