// Changes that make a photo harder to use. Where a camera and its pose change with the pixels, the new ones follow from the old.
#pragma once

#include "core/geo/transform.h"
#include "core/image/image.h"

namespace skyquilt::bench {

// A quarter turn clockwise: the left column becomes the top row.
image::Image8 TurnedClockwise(const image::Image8& photo);
// Pose of a camera whose photo was turned so.
geo::Rigid3d TurnedClockwise(const geo::Rigid3d& cam_from_world);

// Mean of `length_px` pixels along each column, fewer at the ends: the drone flew on while the shutter was open. length_px >= 1.
image::Image8 MovedWhileOpen(const image::Image8& photo, int length_px);

// The middle `width` x `height` pixels, 1 to the size of the photo; the focal length in pixels stays the same. The differences of the sizes are even,
// so that the middle stays the middle.
image::Image8 MiddleOf(const image::Image8& photo, int width, int height);

}  // namespace skyquilt::bench
