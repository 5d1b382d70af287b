// The shading of photos from sparse points that several photos show: the part of tie_point_gains.h that solves for the knots of all photos' grids.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/brightness/response.h"
#include "core/brightness/shading.h"

namespace skyquilt::worker {

// A point in a photo, of sightings that are sorted by their point.
struct ShadedSighting {
  int point = 0, photo = 0;
  brightness::PicturePlace place = {0.0F, 0.0F};
  double log_light = 0.0;  // recorded, divided by all factors but shading
  double weight = 0.0;     // of its square, >= 0
};

// Solves  log_light = log light of the point + log shading of the photo at the place  for the shading of all photos that learn and for the points, by
// weighted least squares with the prior of shading.h: residuals have a standard deviation of kShadingScatter. The points are eliminated; the rest is
// solved by conjugate gradients, from response.shading on. Then shading is limited and centred (CentreShading). The others keep theirs.
void SolveShading(std::span<const ShadedSighting> sightings, const brightness::ShadingOptions& options, brightness::Response& response);

}  // namespace skyquilt::worker
