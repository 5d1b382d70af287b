// Rays through the centres of a camera's pixels, exactly those that Scene::RenderCamera renders, for those who render some pixels at a time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/camera/camera.h"
#include "core/camera/pixel_pitch.h"
#include "core/geo/transform.h"
#include "core/render/ray.h"

namespace skyquilt::scene {

class CameraRays {
 public:
  // cones: the scene has cones (Scales::Cones), so that each pixel's own angle matters.
  CameraRays(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu, bool cones);

  // pixels: row * width + column each; `out` has the same length. Thread-safe.
  void Make(std::span<const size_t> pixels, std::span<render::Ray> out) const;
  // All pixels of a row of the picture.
  void MakeRow(int row, std::span<render::Ray> out) const;

 private:
  camera::Camera camera_;
  geo::Rigid3d enu_from_cam_;
  float nominal_;
  std::optional<camera::PixelPitch> pitch_;
};

// An image is rendered in square tiles, row by row: rays that are rendered together see the same places, so the hash table entries they read are in
// cache.
int TileCount(int width, int height);
// Appends the pixels of the tiles first <= tile < end, row by row within a tile.
void AppendTilePixels(int width, int height, int first, int end, std::vector<size_t>* pixels);

}  // namespace skyquilt::scene
