// Trust in the rendering of a held-out photo, beside the errors that it has.
#pragma once

#include <span>
#include <vector>

#include "core/trust/trust.h"
#include "evaluate/photos/photo_scorer.h"
#include "evaluate/trust/sparsification.h"

namespace skyquilt::evaluate::photos {

struct PhotoTrust {
  skyquilt::trust::TrustPicture expected;  // empty: trust was not measured
  trust::TrustPixels sample;               // a few thousand of the scored pixels, evenly over the photo
  double expected_psnr_db = kNotMeasured;  // of the scored pixels
};

// Before the photo's response is applied to what was rendered.
std::vector<skyquilt::trust::PixelFacts> FactsOfPhoto(const skyquilt::trust::Trust& trust, const HeldOutPhoto& task, bool cones,
                                                      std::span<const render::RayColor> rendered, base::ThreadPool& threads);
// recorded: as the photo would have recorded the rendering, which was scored. scored: as PhotoResult::scored.
PhotoTrust CompareTrust(const skyquilt::trust::Trust& trust, const std::vector<skyquilt::trust::PixelFacts>& facts, const HeldOutPhoto& task,
                        std::span<const render::RayColor> recorded, const image::Image8& scored, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::photos
