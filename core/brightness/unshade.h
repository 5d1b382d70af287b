// Brings a photo into the light of the scene where its own colours are used: in orthophotos and textures.
#pragma once

#include <vector>

#include "core/brightness/response.h"
#include "core/image/image.h"

namespace skyquilt::brightness {

// The shading of photos without the rest of their response.
struct PhotoShading {
  ShadingGrid grid;
  std::vector<float> log_shading;  // [photo][row][column]; empty: no photo is changed

  static PhotoShading Of(const Response& response) { return {response.shading_grid, response.shading}; }
};

// Divides the linear light of the pixels by the photo's shading and rounds to whole display values; what becomes brighter than white is white. rgb:
// the whole photo at any size. Nothing without shading.
void DivideByShading(const PhotoShading& shading, size_t photo, image::Image8& rgb);

}  // namespace skyquilt::brightness
