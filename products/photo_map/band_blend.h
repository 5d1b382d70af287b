// Multi-band blending of pictures that overlap (Burt and Adelson 1983, "A multiresolution spline with application to image mosaics").
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/image/image.h"

namespace skyquilt::products {

// Each layer is split into bands of detail, band l (of pixels of 2^l) weighted by the layer's mask blurred as much as the band is coarse. So fine
// detail comes from one layer up to the seam, without ghosts, and differences of light fade over about 2^(levels + 1) pixels on both sides. Band l of
// the result is sum_layers mask_l * band_l / sum_layers mask_l. One picture per object, one thread per object. Memory: 22 bytes per pixel of the
// picture, and 22 per pixel of the layer while it is added.
class BandBlender {
 public:
  // levels: how often pictures are halved; fewer when the shorter side would have fewer than 2 pixels.
  BandBlender(int width, int height, int levels);
  int levels() const { return levels_; }

  // rgb: three channels, of the rectangle with its upper left corner at (x, y), multiples of 2^levels, inside the picture. mask: one number per pixel
  // of rgb, >= 0, that says where the layer is wanted; it is 0 outside the rectangle. The masks of all layers sum to 1 where a result is wanted, to 0
  // elsewhere. Pixels within 2^(levels + 1) of mask > 0 shape the result; those further away hardly (up to 2^(levels + 2), by a hundredth or less),
  // so a rectangle needs the former around its mask. Pixels that are unknown should be filled with something alike; those that are not finite count
  // as the nearest finite pixel of their row (0 in rows without any). Throws std::logic_error for other shapes and places.
  void Add(const image::ImageF& rgb, std::span<const float> mask, int x = 0, int y = 0);

  // The blended picture, three channels. Meaningless but finite where no mask was above 0. Once, after all layers: the object is empty then.
  image::ImageF Finish();

 private:
  struct Plane {
    int width = 0;
    int height = 0;
    std::vector<float> data;
    Plane() = default;
    Plane(int w, int h) : width(w), height(h), data(static_cast<size_t>(w) * static_cast<size_t>(h)) {}
    float* Row(int y) { return data.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
    const float* Row(int y) const { return data.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
  };
  struct Level {
    std::array<Plane, 3> color;  // sum of mask * band
    Plane weight;                // sum of masks
  };
  static Plane Reduce(const Plane& fine);
  template <typename Function>
  static void ExpandRows(const Plane& coarse, int height, const Function& function);

  int width_;
  int height_;
  int levels_;
  std::vector<Level> sums_;  // [0..levels]: the last one is the coarsest, a picture and no band
};

}  // namespace skyquilt::products
