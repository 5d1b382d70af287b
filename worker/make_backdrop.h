// The survey's backdrop from its training photos.
#pragma once

#include "core/scene/backdrop.h"
#include "core/survey/survey.h"
#include "worker/ray_source.h"

namespace skyquilt::worker {

// Colours of the photos' tiles laid on the surface of the sparse points, blurred by about three tiles (heights are not known better), and
// continued to where no photo looked. Without points only the mean colour.
scene::Backdrop MakeBackdrop(const RaySource& source, const survey::Survey& survey, const scene::PlanSurface& points, uint64_t seed);

}  // namespace skyquilt::worker
