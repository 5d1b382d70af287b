// Photos as pinhole pictures in grey, as depth is refined with them.
#pragma once

#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/kernel/match.h"
#include "core/survey/survey.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// The photo pose.photo as the view shows it, without its lens's distortion. A pixel is the mean of the photo's pixels in it. What the photo does not
// show, or its mask ignores, is black.
kernel::MatchPicture PictureOf(const ViewPose& pose, const survey::Survey& survey, const image::PixelCache& photos, base::ThreadPool& threads);

}  // namespace skyquilt::surface
