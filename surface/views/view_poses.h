// Pinhole cameras at the places of photos. A pinhole has no distortion, so its image is a rectangle inside the area that the photo shows. Photos that
// are held out have none: the mesh is scored from their places.
#pragma once

#include <optional>
#include <vector>

#include "surface/surface_input.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface {

// Image area on the plane at distance 1 in front of the camera: x / z grows from left to right, y / z from top to bottom.
struct TangentRectangle {
  double left = 0.0, right = 0.0, top = 0.0, bottom = 0.0;
  double Width() const { return right - left; }
  double Height() const { return bottom - top; }
};

// A large rectangle that lies inside the photo everywhere and reaches at most 55 degrees from the optical axis on each side. Nothing when the camera
// cannot be used.
std::optional<TangentRectangle> InnerRectangle(const camera::Camera& camera);

// The middle of the rectangle in whole pixels; at least 1 x 1. The remaining fractions of pixels are cut off evenly.
ViewPose PinholeOf(const TangentRectangle& rectangle, double focal_px, const geo::Rigid3d& cam_from_enu);

// The sizes of pictures of depth, pixels.
constexpr int kLeastViewWidth = 16;
constexpr double kMaxViewPixels = 4e6;

struct PhotoPlaces {
  std::vector<ViewPose> training;  // of the photos that are not held out, in the order of the survey
  double agl_m = 0.0;              // median height of these photos above ground, or of level ones their distance to what they show; 0 without any
};

// A pixel is options.view_gsd ground sampling distances wide at the photo's height above ground (where it is unknown, the median of the training
// photos), of photos that look level at their median distance to the sparse points that they observed, but never finer than the photo's own. Photos
// whose camera cannot be used are left out with a warning.
PhotoPlaces PlacesOfPhotos(const SurfaceInput& input);

}  // namespace skyquilt::surface
