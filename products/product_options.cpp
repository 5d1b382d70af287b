#include "products/product_options.h"

namespace skyquilt::products {
std::vector<config::Field<ProductOptions>> ProductOptions::Fields() {
  using config::Range;
  using O = ProductOptions;
  return {
      {"ortho", &O::ortho, Range(), "make the orthophoto"},
      {"dsm", &O::dsm, Range(), "make the digital surface model"},
      {"resolution_m", &O::resolution_m, Range{0, 1e5}, "metres per cell of both; 0: the ground sampling distance, rounded"},
      {"max_pixels", &O::max_pixels, Range{1, 1e11}, "largest map in cells; maps of automatic resolution are coarsened to fit"},
      {"min_opacity", &O::min_opacity, Range{0.01, 0.99}, "cells whose ray stays more transparent than this have no data"},
      {"preview_width", &O::preview_width, Range{16, 16384}, "pixels of the PNG previews"},
      {"exposure", &O::exposure, Range(), "normal (one brightness everywhere), stops above it, -10..10, or the name of a photo to look like"},
      {"video_path", &O::video_path, Range::OneOf({"orbit", "flyover"}), "how the camera of the video flies"},
      {"video_seconds", &O::video_seconds, Range{0, 3600}, "length of the video; 0: none"},
      {"video_fps", &O::video_fps, Range{1, 120}, "frames per second"},
      {"video_width", &O::video_width, Range{16, 16384}.MultipleOf(2), "pixels; even, as H.264 asks"},
      {"video_height", &O::video_height, Range{16, 16384}.MultipleOf(2), "pixels; even, as H.264 asks"},
  };
}

void ProductOptions::Check() const {
  config::CheckRanges("products", *this);
}

}  // namespace skyquilt::products
