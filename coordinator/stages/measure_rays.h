// Measures how fast a scene is rendered, before hours of rendering are planned.
#pragma once

#include "coordinator/stages/pipeline.h"

namespace skyquilt::coordinator {

// Rays per second that all ranks together render from places of training photos at the training width; takes about a second and the loading of the
// scene. 0 when there is no photo to look from. Throws base::InputError for a scene or a survey that cannot be read, base::Interrupted.
double MeasureRays(Pipeline& pipeline);

}  // namespace skyquilt::coordinator
