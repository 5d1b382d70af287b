// Colours of texels, rendered from the field.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "surface/surface_input.h"
#include "surface/texture/view_choice.h"

namespace skyquilt::surface {

struct TexelColors {
  std::vector<std::array<float, 3>> rgb_srgb;  // display values; without meaning where unknown
  std::vector<uint8_t> known;                  // 0: nothing to be seen there
};

struct RayWindow {
  double before_m = 0.0, behind_m = 0.0;  // of the mesh, along the ray: what is rendered
};

// The ray to a place on the mesh from its view's camera, or against the normal when there is none or it sees the place at too flat an angle.
render::Ray RayToTexel(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal, const Eigen::Vector3d* camera_enu, const RayWindow& window,
                       float width_m);

// A texel to be rendered.
struct TexelRay {
  uint32_t texel = 0;
  int32_t view = -1;     // whose camera looks; -1: against the normal
  float width_m = 0.0F;  // of the ray
};

// One colour per ray, in batches. The colour is what the ray met, whatever its opacity above 0.05; below, it is unknown.
TexelColors RenderTexels(const TileGeometry& geometry, const AtlasTexels& texels, std::span<const TexelRay> wanted, std::span<const DepthView> views,
                         const RayCaster& caster, const RayWindow& window, base::ThreadPool& threads);

}  // namespace skyquilt::surface
