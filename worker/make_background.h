// The survey's background from its training photos.
#pragma once

#include "core/scene/background.h"
#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Colours of the photos' tiles laid on the surface of the sparse points, blurred by about three tiles (heights are not known better), and
// continued to where no photo looked. Without points only the mean colour.
scene::Background MakeBackground(const RaySource& source, const survey::Survey& survey, const scene::HeightMap& points, uint64_t seed);

}  // namespace skyquilt::worker
