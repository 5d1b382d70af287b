// Rays at the true surface of a simulated survey: what a scene without any error would show.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/image/pixel_cache.h"
#include "core/raytrace/traced_scene.h"
#include "core/render/ray.h"
#include "core/survey/survey.h"
#include "evaluate/surface/true_surface.h"

namespace skyquilt::bench {

// Depths are those of the mesh, without any blur. The colour of a place is that of the nearest training photo that sees it, as the photo has it; grey
// where none of the nearest kCandidates does. Moving cars are in photos, not in the mesh: they are only a colour on the road.
class TrueRays {
 public:
  // pixels: entry i belongs to survey.photos[i]; null: everything is grey. Survey and pixels must outlive it.
  TrueRays(evaluate::surface::TrueSurface truth, const survey::Survey& survey, const image::PixelCache* pixels);

  // Fills `seen`, which is as long as `rays`. The same for any number of threads.
  void Cast(std::span<const render::Ray> rays, std::span<render::RayColor> seen, base::ThreadPool& threads) const;

 private:
  static constexpr int kCells = 24;          // per side
  static constexpr size_t kCandidates = 24;  // photos that are asked for a colour
  using Rgb = std::array<uint8_t, 3>;
  struct Camera {
    camera::Camera camera;  // at the size of the cached photo
    geo::Rigid3d cam_from_enu;
    Eigen::Vector3d centre;
    size_t photo = 0;
  };
  // Up to raytrace::kPacket rays.
  void CastPacket(std::span<const render::Ray> rays, std::span<render::RayColor> seen) const;
  // Nothing when the place is not in the frame, or masked. What hides it is not asked.
  std::optional<Rgb> ColorIn(const Camera& camera, const Eigen::Vector3d& x_in_enu) const;
  const std::vector<size_t>& Nearest(const Eigen::Vector3d& x_in_enu) const;

  evaluate::surface::TrueSurface truth_;
  raytrace::TracedScene traced_;  // relative to truth_.middle
  const image::PixelCache* pixels_;
  std::vector<Camera> cameras_;  // of the training photos
  // Cells over the cameras, seen from above; per cell the cameras nearest to its middle, the nearest first.
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), cell_m_ = Eigen::Vector2d::Ones();
  std::vector<std::vector<size_t>> nearest_;
};

}  // namespace skyquilt::bench
