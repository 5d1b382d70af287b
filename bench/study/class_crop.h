// Finds the part of a photo that shows most of one kind of surface, to choose what a picture shows without looking at the results.
#pragma once

#include <cstdint>

#include "bench/study/picture_sheet.h"
#include "core/image/image.h"
#include "core/survey/surface_class.h"

namespace skyquilt::bench {

struct ClassCrop {
  PicturePart part;
  int64_t pixels = 0;  // of the wanted class in it
};

// The part of width x height pixels (at most the image) with most pixels of the class; of several the one closest to the middle, and then the first
// in rows from the top. Without such pixels it is the middle, with 0 pixels. classes: one channel of survey::SurfaceClass.
ClassCrop CropWithMost(const image::Image8& classes, survey::SurfaceClass wanted, int width, int height);

}  // namespace skyquilt::bench
