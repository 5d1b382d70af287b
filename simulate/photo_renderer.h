// Renders the photos of a simulated survey by ray tracing: linear colour, a mask of what moves, and the true surface.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/camera/equirectangular.h"
#include "core/geo/transform.h"
#include "core/image/image.h"
#include "simulate/ray_shader.h"
#include "simulate/world.h"

namespace skyquilt::simulate {

struct Rendering {
  image::ImageF rgb_linear;  // radiance before the photo's exposure
  image::Image8 usable;      // mask: 0 on a moving car, a person or their shadows, 255 elsewhere; empty when the photo shows none
};

// The surface that a camera sees at its pixel centres, moving cars and people included.
struct SurfaceImages {
  image::ImageF z_depth;  // metres along the camera's z axis; NaN for sky
  image::ImageF normals;  // three channels: unit normal of the triangle in ENU, on the camera's side; NaN for sky
  image::Image8 classes;  // survey::SurfaceClass
};

class PhotoRenderer {
 public:
  // samples_per_pixel 1, 4 or 16, on a regular grid. Holds a reference: the world must outlive it.
  PhotoRenderer(const World& world, const camera::Camera& camera, int samples_per_pixel, bool soft_shadows);
  // Of panoramas. The depth of their surfaces is along z, too, and so says little.
  PhotoRenderer(const World& world, const camera::Equirectangular& panorama, int samples_per_pixel, bool soft_shadows);

  // The same image for any number of threads. `advance` is called by any of them with the shares of the work that they finish.
  Rendering Render(const geo::Rigid3d& cam_from_enu, const MovingScene& moving, base::ThreadPool& threads,
                   const std::function<void(double share)>& advance = {}) const;
  // The same images for any number of threads.
  SurfaceImages Surfaces(const geo::Rigid3d& cam_from_enu, const MovingScene& moving, base::ThreadPool& threads) const;

 private:
  using RayFromImg = std::function<Eigen::Vector3d(const Eigen::Vector2d& pixel)>;  // unit direction in the camera's frame
  struct Frame;                                                                     // one photo's pose in single precision
  PhotoRenderer(const World& world, int width, int height, double pixel_angle, RayFromImg ray_from_img, int samples_per_pixel, bool soft_shadows);
  void SetRays(const Frame& frame, int tile_x, int tile_y, raytrace::RayPacket& rays) const;
  void ShadeTile(const Frame& frame, const MovingScene& moving, int tile_x, int tile_y, Rendering& out, std::vector<char>& row_masked) const;

  const World& world_;
  int width_, height_;  // pixels
  double pixel_angle_;  // radians, in the middle
  RayFromImg ray_from_img_;
  RayShader shader_;
  int grid_;                                       // samples per pixel side
  std::vector<Eigen::Vector3f> sample_direction_;  // camera frame, unit, (width * grid) x (height * grid)
};

}  // namespace skyquilt::simulate
