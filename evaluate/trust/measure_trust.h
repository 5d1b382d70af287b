// Compares a finished scene with the training photos: how well it agrees with them in each place, and which errors to expect, from tiles that nothing
// was learned from (core/trust/left_out_tiles.h).
#pragma once

#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/scene/scene.h"
#include "core/survey/survey.h"
#include "core/trust/trust.h"
#include "core/trust/trust_options.h"

namespace skyquilt::evaluate::trust {

// pixels: as trained; entry i belongs to survey.photos[i]. Trust::scene is left empty. Where no tile shows the scene, the same error is expected
// everywhere. The same for any number of threads and ranks. Throws base::Interrupted.
skyquilt::trust::Trust MeasureTrust(const scene::Scene& scene, const survey::Survey& survey, const image::PixelCache& pixels,
                                    const skyquilt::trust::TrustOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::trust
