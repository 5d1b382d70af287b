// Pinhole views of an equirectangular picture.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/camera/equirectangular.h"
#include "core/image/image.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::rigs {

// Which part of a sphere a picture shows.
struct SphereArea {
  camera::Equirectangular sphere;  // pixels as large as the picture's
  int left = 0, top = 0;           // of the picture in it
  int width = 0, height = 0;       // of the picture

  bool GoesAround() const { return left == 0 && width == sphere.width; }
  bool IsWhole() const { return GoesAround() && top == 0 && height == sphere.height; }
};

// By its tags; without, the whole of 360 degrees, and of the height what it shows around the horizon. The file is a panorama.
SphereArea AreaOf(const input::PhotoFile& panorama);

// The direction of a view's pixel in the panorama's frame, a unit vector.
Eigen::Vector3d PanoramaRay(const camera::Camera& camera, const Eigen::Quaterniond& cam_from_pano, const Eigen::Vector2d& pixel);

// The view of a picture with three channels. A pixel is the mean, in linear light, over its area: cubic (Catmull-Rom) samples as near to each other
// as the panorama's pixels, so that neither the rows near the poles nor smaller views alias. Black where the picture shows nothing. The same for any
// number of threads.
image::Image8 RenderView(const image::Image8& panorama, const SphereArea& area, const camera::Camera& camera, const Eigen::Quaterniond& cam_from_pano,
                         base::ThreadPool& threads);

// What of the view is to be ignored: 0 within `nadir_deg` of the panorama's lower pole, where the picture shows nothing, and where its own mask (of
// its size; empty: none) ignores, else 255. Empty when nothing is.
image::Image8 MaskOfView(const image::Image8& panorama_mask, const SphereArea& area, const camera::Camera& camera,
                         const Eigen::Quaterniond& cam_from_pano, double nadir_deg, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::rigs
