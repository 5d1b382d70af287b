// Renders one picture from the field.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/image/image.h"
#include "tour/pictures/picture_field.h"
#include "tour/pictures/picture_request.h"

namespace skyquilt::tour {

struct RenderedPicture {
  image::Image8 color;  // display values
  // To where half of the light is left, of all pixels, NaN where there is no surface: of a panorama metres along the ray from the eye, of a still
  // along the optical axis, as frames of the viewer have it.
  std::vector<float> depth_m;
};

// caster: of the field, in the exposure of the request. on_rays is called after each batch with the number of rays in it. The same bits for any size
// of batches, any number of threads, ranks and blocks in memory. Throws base::Interrupted, and what the caster throws.
RenderedPicture RenderPicture(const PictureRequest& request, const PictureField& field, const products::RayCaster& caster,
                              const std::function<void(int64_t rays)>& on_rays);

}  // namespace skyquilt::tour
