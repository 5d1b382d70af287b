#include "products/normal_pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/scene/depth_normals.h"

namespace skyquilt::products {
namespace {

// From metres along the ray to metres along the camera's axis; NaN for rays that do not look forward.
image::ImageF ZDepthOf(const View& view, std::span<const render::RayColor> colors, base::ThreadPool& threads) {
  image::ImageF z_depth(view.camera.width, view.camera.height, 1, std::numeric_limits<float>::quiet_NaN());
  threads.ParallelFor(view.camera.height, [&](int64_t row, int) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < view.camera.width; ++x) {
      const double along_axis = view.camera.RayFromImg({x + 0.5, y + 0.5}).z();
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(view.camera.width) + static_cast<size_t>(x);
      if (along_axis > 0.0) *z_depth.At(x, y) = static_cast<float>(static_cast<double>(colors[i].depth_median) * along_axis);
    }
  });
  return z_depth;
}

image::ImageF RenderedNormals(NormalKind kind, const View& view, std::span<const render::RayColor> colors) {
  image::ImageF normals(view.camera.width, view.camera.height, 3, std::numeric_limits<float>::quiet_NaN());
  for (size_t i = 0; i < colors.size(); ++i) {
    const float* const n = kind == NormalKind::kPredicted ? colors[i].predicted_normal : colors[i].density_normal;
    const bool none = std::isnan(colors[i].depth_median) || (n[0] == 0.0F && n[1] == 0.0F && n[2] == 0.0F);
    if (!none) std::copy_n(n, 3, normals.data.data() + 3 * i);
  }
  return normals;
}

}  // namespace

NormalKind NormalKindNamed(const std::string& name) {
  if (name == "depth") return NormalKind::kDepth;
  if (name == "density") return NormalKind::kDensity;
  if (name == "predicted") return NormalKind::kPredicted;
  throw base::UsageError("normals '" + name + "' are not known: give 'depth', 'density' or 'predicted'");
}

void RequireNormals(NormalKind kind, const scene::SceneInfo& info) {
  if (kind == NormalKind::kPredicted && !info.normal_head) {
    throw base::UsageError("this scene's fields were trained without a normal head, so no normals are predicted: choose 'depth' or 'density'");
  }
}

image::ImageF NormalsOfView(NormalKind kind, const View& view, std::span<const render::RayColor> colors, base::ThreadPool& threads) {
  SKYQUILT_CHECK(colors.size() == static_cast<size_t>(view.camera.width) * static_cast<size_t>(view.camera.height), std::to_string(colors.size()));
  if (kind != NormalKind::kDepth) return RenderedNormals(kind, view, colors);
  return scene::NormalsOfDepth(view.camera, view.cam_from_enu, ZDepthOf(view, colors, threads), {}, threads);
}

}  // namespace skyquilt::products
