// Scores of several trainings on the ground of each block, so that one field can be compared with blocks place by place.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/study/study.h"
#include "core/geo/block_box.h"
#include "core/survey/survey.h"

namespace skyquilt::bench {

// PSNR of the first training of each result in each box, [result][box]: over the pixels of held-out photos that all of them score
// (evaluate/photos/scored_pixels.h), per box all pixels together. A pixel belongs to the box in which its ray reaches level ground as far below the
// camera as the sparse points there: on high roofs in slanted photos that is the place behind them, but it is the same for all results. Results
// without such pictures get NaN. folder: of the study.
std::vector<std::vector<double>> ScoreGround(const std::filesystem::path& folder, const survey::Survey& survey,
                                             const std::vector<geo::BlockBox>& boxes, const std::vector<const VariantResult*>& results);

}  // namespace skyquilt::bench
