// Renders one picture of depth.
#pragma once

#include <functional>

#include "surface/surface_input.h"
#include "surface/views/depth_filter.h"

namespace skyquilt::surface {

// What of a rendering is used.
DepthLimits LimitsOf(const SurfaceInput& input, double voxel_m);

// One ray through the centre of each pixel, if it meets the box of the scene; in batches, after each of which on_pixels is called with the number of
// pixels in it. Throws base::Interrupted and what the caster throws.
RenderedView RenderView(const ViewPose& pose, const RayCaster& caster, const DepthLimits& limits, base::ThreadPool& threads,
                        const std::function<void(int64_t pixels)>& on_pixels);

}  // namespace skyquilt::surface
