// A held-out photo as it is scored: pixels, mask, camera and, for simulated surveys, true depth.
#pragma once

#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "evaluate/photo_scorer.h"

namespace skyquilt::evaluate {

// At image_width pixels (0: as cached), from the cache when that is large enough, else decoded again. Throws base::InputError.
PhotoTask LoadTask(const survey::Survey& survey, const image::PixelCache& pixels, int index, int image_width);

}  // namespace skyquilt::evaluate
