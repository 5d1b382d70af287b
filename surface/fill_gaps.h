// Closes what a mesh leaves open with parts of a coarser one.
#pragma once

#include <span>

#include "core/base/thread_pool.h"
#include "surface/mesh.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Adds the triangles of `coarse` that a photo sees through gaps of the mesh: its ray meets them first, from their front, and then meets nothing of
// the mesh, or its back, or a part more than a voxel behind that is not where the picture of depth has its surface. One ray in four pixels is traced,
// and triangles that touch such ones are added too. voxel_m: of the coarse mesh. Where they overlap the mesh at its rim they are moved half a voxel
// back, and are not joined to it. Their vertices have filled = 1, views = 0 and keys with kFilledKeyBit. Returns the area added, square metres. Same
// result for any number of threads. Throws base::Interrupted.
double FillGaps(const Mesh& coarse, double voxel_m, std::span<const DepthView> views, base::ThreadPool& threads, Mesh* mesh);

}  // namespace skyquilt::surface
