// Estimates the photos' gains before training from sparse points that several photos show, because gradients would need many steps to align photos
// that hardly overlap. The pixels at each point are read from every training photo that shows it, and
//   log recorded light = log light of the point + log gain of the photo + log vignetting of its camera at the pixel
// is solved for all unknowns by robust weighted least squares (Brown and Lowe 2007, section 6, in the logarithm); robust, because points are hidden
// in some photos. With shading, log shading of the photo at the pixel is another term (tie_point_shading.h). Photos that look level have many points
// behind walls: of these only the points that a photo observed are read.
#pragma once

#include "core/brightness/response.h"
#include "core/brightness/response_learner.h"
#include "core/image/pixel_cache.h"
#include "core/survey/survey.h"
#include "worker/rays/ray_source.h"

namespace skyquilt::worker {

// Sets response.log_gain of the photos that learn their gain (learn.learns_gain), response.vignetting when learn.vignetting is true, and
// response.shading with learn.shading. The other
// photos keep their gains and fix the common factor; when learn.anchored is false, the mean log gain is zero. Photos with fewer than 8 usable points
// keep their gains. What is known need not be learned in training: gains when at least 95 % of the photos that learn have enough points, shading when
// as many of them have four points per knot.
struct KnownFromTiePoints {
  bool gains = false;
  bool shading = false;
};
KnownFromTiePoints GainsFromTiePoints(const survey::Survey& survey, const image::PixelCache& pixels, const RaySource& source,
                                      const brightness::LearnerOptions& learn, brightness::Response& response, base::ThreadPool& threads);

}  // namespace skyquilt::worker
