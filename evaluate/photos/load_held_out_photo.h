// Loads a held-out photo for scoring: pixels, mask, camera and, for simulated surveys, the true surface.
#pragma once

#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::photos {

// index: into Survey::photos. image_width: pixels, 0 = as cached. Taken from the cache if that is large enough, otherwise decoded again. Throws
// base::InputError when a file cannot be read.
HeldOutPhoto LoadHeldOutPhoto(const survey::Survey& survey, const image::PixelCache& pixels, int index, int image_width);

}  // namespace skyquilt::evaluate::photos
