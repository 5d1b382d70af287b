// Which pictures of depth saw the texels of a tile, as squarely and from as near as possible.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surface/texture/texels.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Seen at a flatter angle to its normal, a texel is not coloured from a view.
constexpr double kLeastViewCosine = 0.1;
constexpr int kBlockTexels = 8;  // sides of the blocks of a chart that share views
constexpr size_t kKeptViews = 4;
constexpr double kFilledTolerance = 4.0;  // of what closes gaps, in tolerances of the measured surface

// False only when nothing of the ball can be in the picture.
bool MayShow(const ViewPose& pose, const Eigen::Vector3d& centre, double radius_m);

// The point is in the picture, and the surface seen there is less than tolerance_m nearer or farther.
bool Sees(const DepthView& view, const Eigen::Vector3d& x_in_enu, double tolerance_m);
// Sees, and neither is the surface seen in any of the pixels around nearer by that much: where something begins to hide the point.
bool SeesClearly(const DepthView& view, const Eigen::Vector3d& x_in_enu, double tolerance_m);

// Texels of a chart in a square of kBlockTexels.
struct TexelBlock {
  std::vector<uint32_t> texel;                // rising
  uint32_t middle = 0;                        // the texel nearest to the middle of the square
  std::array<int32_t, kKeptViews> view = {};  // indices into the views, the best first; -1: no more
};

// The views are those that see the middle texel, by the cosine (between the direction to the camera and the normal) / distance; those of photos
// first, and a virtual one only without any. Of the views into whose picture the point falls, only the 24 best are tried of each kind. Each texel is
// in one block. Same result for any number of threads.
std::vector<TexelBlock> ChooseViews(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels,
                                    std::span<const DepthView> views, double tolerance_m, base::ThreadPool& threads);

}  // namespace skyquilt::surface
