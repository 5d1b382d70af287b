// Normals of a rendered or true depth image: of every pixel the plane that fits the surface points of its neighbours best.
#pragma once

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/image/image.h"

namespace skyquilt::scene {

struct DepthNormalOptions {
  int radius_px = 2;         // the plane is fitted to a square of 2 radius + 1 pixels
  double max_tilt_deg = 80;  // neighbours that would need a surface steeper than this towards the ray lie behind an edge and do not count
};

// z_depth: metres along the camera's z axis at pixel centres, one channel with the size of the camera's image; NaN: no surface. Returns three
// channels: unit vectors in ENU that point towards the camera; NaN where the depth is NaN or fewer than half of the neighbours count. The same result
// for any number of threads.
image::ImageF NormalsOfDepth(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, const image::ImageF& z_depth,
                             const DepthNormalOptions& options, base::ThreadPool& threads);

}  // namespace skyquilt::scene
