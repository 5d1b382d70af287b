// Pictures of depth from which the surface is fused: renderings of the scene from the places of photos, and from virtual places where photos leave
// gaps. They are kept in one file that is mapped into memory, so that their number is not limited by it.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/memory_map.h"
#include "core/geo/transform.h"

namespace skyquilt::surface {

// A pinhole camera without distortion, whatever the photo's lens: x right, y down, z forward; the centre of the first pixel is (0.5, 0.5).
struct ViewPose {
  int photo = -1;  // index into Survey::photos; -1: a virtual view
  int width = 0, height = 0;
  double focal_px = 0.0, cx = 0.0, cy = 0.0;
  geo::Rigid3d cam_from_enu;

  Eigen::Vector3d Centre() const { return cam_from_enu.OriginInSource(); }
  // Nothing when the point is not in front of the camera or outside the image.
  std::optional<Eigen::Vector2d> Project(const Eigen::Vector3d& x_in_enu) const {
    const Eigen::Vector3d x = cam_from_enu * x_in_enu;
    if (!(x.z() > 0.0)) return std::nullopt;
    const Eigen::Vector2d pixel(focal_px * x.x() / x.z() + cx, focal_px * x.y() / x.z() + cy);
    if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() < width && pixel.y() < height)) return std::nullopt;
    return pixel;
  }
  // Unit direction in ENU through an image position.
  Eigen::Vector3d DirectionAt(double x, double y) const {
    return (cam_from_enu.rotation.conjugate() * Eigen::Vector3d((x - cx) / focal_px, (y - cy) / focal_px, 1.0)).normalized();
  }
};

// As the cosine of a pixel without depth: its ray meets nothing at all where the scene has surface.
constexpr uint8_t kMeetsNothing = 255;
// Weights of depths. A confirmed one counts as much as others in full, but another photo found it too, so it stands for two views.
constexpr uint8_t kFullWeight = 254, kConfirmedWeight = 255;

// One picture, row-major.
struct DepthView {
  ViewPose pose;
  std::span<const float> depth_m;   // median depth along the ray through the pixel's centre, metres; NaN: none, or not trusted
  std::span<const uint8_t> cosine;  // 255 times the cosine of the angle between ray and surface normal; 0 or kMeetsNothing where there is no depth
  std::span<const uint8_t> weight = {};  // how much each depth counts beside others, of kFullWeight, or kConfirmedWeight; empty: all of them in full
};

class DepthViews {
 public:
  // Throws base::InputError when the file cannot be read or is damaged.
  static DepthViews Open(const std::filesystem::path& file);
  // Gives back the memory of pictures that were read.
  void ReleasePages() const { map_.ReleasePages(); }
  size_t size() const { return poses_.size(); }
  const ViewPose& pose(size_t view) const { return poses_[view]; }
  DepthView operator[](size_t view) const;
  std::vector<DepthView> All() const;
  // Stands for everything that the pictures were rendered from.
  const std::string& key() const { return key_; }

 private:
  base::MemoryMap map_;
  std::vector<ViewPose> poses_;
  std::vector<size_t> offset_;  // of the depth of each view in the file; its cosines follow
  std::string key_;
};

}  // namespace skyquilt::surface
