// How much of a held-out photo's error is its own pose: the pose is fitted to the scene on one half of the photo's tiles (alternate_tiles.h), and the
// photo scored on the other half, with the pose as given and as fitted. The fit is Gauss-Newton over the difference between photo and rendering, both
// reduced, with derivatives by finite differences of whole renderings. Reduced pixels at the borders of tiles average over both kinds by a little.
#pragma once

#include <functional>
#include <vector>

#include "core/survey/refined_poses.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::photos {

// Renders a picture at the photo's brightness, row-major.
using PhotoRenderer = std::function<std::vector<render::RayColor>(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu)>;

struct ResectedPhoto {
  survey::PoseOffset offset;          // of the given pose, in the camera's axes
  double moved_px = 0.0;              // root mean square by which the offset moves the pixels that were fitted, in pixels of the scored size
  double given_db = kNotMeasured;     // PSNR on the other tiles with the given pose,
  double resected_db = kNotMeasured;  // and with the fitted one
};

// scored: one channel of the photo's size, 0 = ignore. as_given: rendered with the given pose at the photo's brightness. distance_m: of what the
// photo shows, > 0. NaN where nothing is scored. The same result for any number of threads.
ResectedPhoto ResectPhoto(const HeldOutPhoto& task, const image::Image8& scored, std::span<const render::RayColor> as_given, double distance_m,
                          const PhotoRenderer& render);

}  // namespace skyquilt::evaluate::photos
