// Pictures of a surface's textured mesh as a camera sees it.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/image/image.h"
#include "core/raytrace/traced_scene.h"
#include "core/render/ray.h"
#include "evaluate/surface/joined_mesh.h"

namespace skyquilt::evaluate::surface {

struct SurfacePicture {
  std::vector<render::RayColor> colors;  // row-major; opacity 1 and the texture's colour where there is mesh, otherwise 0 and black
  std::vector<uint8_t> has_mesh;         // 1: the ray through the middle of the pixel hits a triangle with texture
};

// Traces one ray through the middle of each pixel, lens distortion included. Not for two threads at once.
class SurfacePainter {
 public:
  // `mesh` must outlive it. Decoded textures are kept up to cache_bytes.
  explicit SurfacePainter(const SurfaceMesh& mesh, int64_t cache_bytes = int64_t{256} << 20);

  // Colours are the texture's, interpolated between its four nearest pixels. The same for any number of threads and any cache. Throws
  // base::InputError for a texture that cannot be decoded.
  SurfacePicture Paint(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, base::ThreadPool& threads);
  const raytrace::TracedScene& traced() const { return traced_; }  // the mesh, relative to its middle

 private:
  struct Hit {
    uint32_t triangle = raytrace::kNoTriangle;
    float u = 0.0F, v = 0.0F;  // weights of the second and third corner
  };
  std::vector<Hit> Trace(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, base::ThreadPool& threads) const;
  void Color(const Hit& hit, const image::Image8& texture, render::RayColor* color) const;
  void Forget(const std::vector<size_t>& kept);

  const SurfaceMesh& mesh_;
  const raytrace::TracedScene traced_;
  const int64_t cache_bytes_;
  int64_t uses_ = 0;
  std::vector<image::Image8> texture_;  // per tile; empty: not decoded
  std::vector<int64_t> last_use_;
};

}  // namespace skyquilt::evaluate::surface
