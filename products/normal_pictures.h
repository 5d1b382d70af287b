// Pictures of the surface normals of a view: ENU, out of the surface (core/image/normal_image.h).
#pragma once

#include <span>
#include <string>

#include "core/base/thread_pool.h"
#include "core/image/image.h"
#include "products/ray_caster.h"

namespace skyquilt::products {

enum class NormalKind {
  kDepth,      // of planes fitted to the median depth of neighbouring pixels (core/scene/depth_normals.h)
  kDensity,    // of the density's gradient (render::RayColor::density_normal)
  kPredicted,  // of the fields' normal heads (render::RayColor::predicted_normal)
};

// "depth", "density", "predicted". Throws base::UsageError that lists the choices.
NormalKind NormalKindNamed(const std::string& name);
// Throws base::UsageError when the scene has no such normals.
void RequireNormals(NormalKind kind, const scene::SceneInfo& info);
// Whether the rays must be rendered with scene::Appearance::normals.
inline bool NeedsRenderedNormals(NormalKind kind) {
  return kind != NormalKind::kDepth;
}

// colors: all pixels of the view, row-major. Unit vectors; NaN where the ray does not become half opaque or has no normal.
image::ImageF NormalsOfView(NormalKind kind, const View& view, std::span<const render::RayColor> colors, base::ThreadPool& threads);

}  // namespace skyquilt::products
