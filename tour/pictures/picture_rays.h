// The rays of one picture, one through the centre of each pixel, for those who render some at a time.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "core/scene/camera_rays.h"
#include "tour/pictures/panorama_rays.h"
#include "tour/pictures/picture_request.h"

namespace skyquilt::tour {

class PictureRays {
 public:
  // cones: the scene has cones (scene::Scales::Cones).
  PictureRays(const PictureRequest& request, bool cones);

  // pixels: row * width + column each; `out` has the same length. Thread-safe.
  void Make(std::span<const size_t> pixels, std::span<render::Ray> out) const;

 private:
  std::variant<PanoramaRays, scene::CameraRays> rays_;
};

// All pixels of a picture, in an order in which they are rendered fast.
std::vector<size_t> PixelsInOrder(const PictureRequest& request);

}  // namespace skyquilt::tour
