// Photos' gains from what they recorded of the same places: sparse points are looked up in every training photo that shows them, and
//   log recorded light = log light of the point + log gain of the photo + log vignetting of its camera there
// is solved for all by weighted least squares, robustly, because points are hidden in some photos (Brown and Lowe 2007, section 6, in the
// logarithm). Where training starts from: gradients would need many steps to align photos that hardly overlap.
#pragma once

#include "core/brightness/response.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// True when nearly all photos that learn share enough points, so that little is left to learn. Sets response.log_gain of the photos that learn, and
// response.vignetting when that is learned; other photos' gains stay and anchor them. Without photos that stay, the mean is zero. Photos that share
// fewer than a few points with others keep what they have.
bool GainsFromTiePoints(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source,
                        const brightness::LearnerOptions& learn, brightness::Response& response, base::ThreadPool& threads);

}  // namespace skyquilt::worker
