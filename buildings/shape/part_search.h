// Finds the set of rectangles that explains the roofs of a building with as few parts as possible.
#pragma once

#include "buildings/shape/part_score.h"

namespace skyquilt::buildings {

// Starts from the rectangle around all cells, a cover of them by maximal rectangles, and one by regions of roof; then the best of these is changed
// one step at a time while its cost falls: a part dropped, split, added, replaced, two made one, one side moved to the next line. The largest part
// comes first. candidates: of CandidateRectangles. Throws base::Interrupted.
ScoredShape FindParts(const WallCells& cells, const std::vector<CellRectangle>& candidates, PartScorer* scorer);

}  // namespace skyquilt::buildings
