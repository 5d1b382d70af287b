// Scores of variants on the pixels that all of them cover: which pixels count for VariantResult::psnr_db depends on the variant's own depth and
// blocks.
#pragma once

#include <filesystem>
#include <vector>

#include "bench/study/study.h"

namespace skyquilt::bench {

// Sets psnr_common_db, of single trainings and of medians over seeds, from the pictures in FOLDER/runs/<variant>/covered
// (evaluate/photos/scored_pixels.h): per held-out photo over the pixels that all these trainings score, mean over photos as that of psnr_db.
// Trainings are compared with those that have the same photos in the same sizes. NaN for a training that has none to compare with, that failed, or
// that an older program scored. folder: of the study. Throws base::InputError for a picture that cannot be read.
void ScoreCommonPixels(const std::filesystem::path& folder, const std::vector<VariantResult*>& results);

}  // namespace skyquilt::bench
