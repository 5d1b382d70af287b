// The rays of one pass of a view, and the depth of their pixels.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/scene/camera_rays.h"
#include "viewer/engine/renderer.h"

namespace skyquilt::viewer {

struct PassSize {
  int width = 0, height = 0;  // pixels
};

// A quarter, half and all of the size, rounded up; without those that are below kMinViewSize in width or height. Never empty.
std::vector<PassSize> PassSizes(int width, int height);

class PassRays {
 public:
  // Square pixels, the principal point in the middle. Perspective: the camera that a camera path with the same field of view across the width gives
  // (products::PinholeCamera). Orthographic: parallel rays that start before the scene.
  PassRays(const ViewRequest& view, PassSize size, const SceneFrame& scene);
  PassRays(const products::View& photo, const SceneFrame& scene);

  // In the scene's frame. pixels: row * width + column.
  void Make(std::span<const size_t> pixels, std::span<render::Ray> out) const;
  // z along the optical axis from the eye, metres; NaN where there is no surface.
  float Depth(const render::Ray& ray, const render::RayColor& color) const;

  PassSize size() const { return size_; }
  // In the main project's frame, as frames report them.
  const Eigen::Vector3d& eye_enu() const { return eye_enu_; }
  const Eigen::Quaterniond& cam_from_enu() const { return cam_from_enu_; }
  double fovy_deg_or_height_m() const { return fovy_deg_or_height_m_; }

 private:
  void Place(const SceneFrame& scene);

  PassSize size_;
  Eigen::Vector3d eye_enu_;
  Eigen::Quaterniond cam_from_enu_;
  double fovy_deg_or_height_m_ = 0.0;
  geo::Rigid3d cam_from_scene_;
  Eigen::Vector3d ahead_;                    // the optical axis in the scene's frame
  std::optional<scene::CameraRays> camera_;  // none: orthographic
  double pixel_m_ = 0.0;                     // orthographic: size of a pixel
  double back_m_ = 0.0;                      // orthographic: rays start this far behind the eye
};

}  // namespace skyquilt::viewer
