// Fine detail of photos, added to colours of the field: a field of limited size is smoother than the photos it was trained on.
#pragma once

#include <span>

#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "surface/texture/texel_colors.h"

namespace skyquilt::surface {

// Adds share * (photo - photo averaged over 4 texels), in sRGB values, to each texel whose view is a photo's, sees it at less than 60 degrees from
// its normal, and shows no masked pixel there. The difference is limited to +-0.25, so that a wrong place does little harm. Photos that are held out
// for evaluation are never read; without any, all are used. tolerance_m: see Sees. Same bits for any number of threads.
void AddPhotoDetail(const TileGeometry& geometry, const AtlasTexels& texels, std::span<const int32_t> view, std::span<const DepthView> views,
                    const survey::Survey& survey, const image::PixelCache& photos, double share, double texel_m, double tolerance_m,
                    base::ThreadPool& threads, TexelColors* colors);

}  // namespace skyquilt::surface
