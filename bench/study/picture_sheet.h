// Parts of pictures, enlarged without smoothing so that single pixels can be seen, and sheets of them with captions.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/survey/surface_class.h"

namespace skyquilt::bench {

// A rectangle of pixels.
struct PicturePart {
  int left = 0, top = 0, width = 0, height = 0;
};

// Every pixel of the part becomes a square of `times` pixels. A part that reaches over the edge is moved inside; one larger than the image is cut.
image::Image8 EnlargedPart(const image::Image8& image, const PicturePart& part, int times);
// The same of the middle of the image, at most width x height pixels.
image::Image8 EnlargedMiddle(const image::Image8& image, int width, int height, int times);

struct CaptionedImage {
  std::string caption;  // ASCII
  image::Image8 image;  // RGB
};
// Rows of images on white, each with its caption above.
image::Image8 PictureSheet(const std::vector<std::vector<CaptionedImage>>& rows);

// The part of a photo that shows most of one kind of surface, to choose what a picture shows without looking at the results.
struct ClassCrop {
  PicturePart part;
  int64_t pixels = 0;  // of the wanted class in it
};

// The part of width x height pixels (at most the image) with most pixels of the class; of several the one closest to the middle, and then the first
// in rows from the top. Without such pixels it is the middle, with 0 pixels. classes: one channel of survey::SurfaceClass.
ClassCrop CropWithMost(const image::Image8& classes, survey::SurfaceClass wanted, int width, int height);

}  // namespace skyquilt::bench
