// From which picture of depth each texel's colour is taken: one that saw it, as squarely and from as near as possible.
#pragma once

#include <span>
#include <vector>

#include "surface/texture/texels.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Seen at a flatter angle to its normal, a texel is not coloured from a view.
constexpr double kLeastViewCosine = 0.1;

// False only when nothing of the ball can be in the picture.
bool MayShow(const ViewPose& pose, const Eigen::Vector3d& centre, double radius_m);

// The point is in the picture, and the surface seen there is less than tolerance_m nearer or farther.
bool Sees(const DepthView& view, const Eigen::Vector3d& x_in_enu, double tolerance_m);

// Index into views for each texel, or -1. Chosen for blocks of texels of a chart, at the one nearest to the middle of the block: the view that sees
// it with the largest cosine (between the direction to the camera and the normal) / distance; of the virtual views only where no photo's sees it. Of
// the views into whose picture the point falls, only the 24 best are tried of each kind. Same result for any number of threads.
std::vector<int32_t> ChooseViews(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, std::span<const DepthView> views,
                                 double tolerance_m, base::ThreadPool& threads);

}  // namespace skyquilt::surface
