// Which photos a photo is compared with, to improve its depths.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Up to `most` other views that show what the view shows from directions that differ by about 15 degrees, the best first: nearer ones tell little
// about depth, and wider ones show other sides of things. The weight of an angle is that of Yao et al. 2018 (MVSNet), with our widths.
std::vector<size_t> NeighboursOf(size_t view, const DepthView& picture, std::span<const ViewPose> poses, size_t most);

}  // namespace skyquilt::surface
