// The pictures of a tour's stops, as they are asked for.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>

#include "products/ray_caster.h"

namespace skyquilt::tour {

enum class PictureKind : uint8_t {
  kPanorama,  // colour and depth in all directions, see panorama_rays.h
  kStill,     // colour, as `skyquilt render` draws it, and depth of what the stop itself looks at
};

struct PictureRequest {
  PictureKind kind = PictureKind::kPanorama;
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();                 // metres
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();  // stills only: a panorama has no direction of its own
  double fovy_deg = 0.0;                                             // stills only: field of view across the height
  int width = 0, height = 0;
  std::string exposure = "normal";  // as products.exposure

  int64_t Rays() const { return static_cast<int64_t>(width) * height; }
};

// width: even, from 2 to kMaxPanoramaWidth. Throws base::UsageError.
constexpr int kMaxPanoramaWidth = 16384;
PictureRequest PanoramaAt(const Eigen::Vector3d& eye_enu, int width, const std::string& exposure);
PictureRequest StillAt(const Eigen::Vector3d& eye_enu, const Eigen::Quaterniond& cam_from_enu, double fovy_deg, int width, int height,
                       const std::string& exposure);

// The view that a camera path with this pose would have.
products::View ViewOfStill(const PictureRequest& still);

// The exposure of a stop that states its stops above normal; of one that does not, `otherwise`.
std::string ExposureText(std::optional<double> stops, const std::string& otherwise);

// 16 characters that stand for everything a picture depends on. identity: of the scene, see PictureField. A stop's own direction is not in the key of
// its panorama, so that turning a stop costs no rendering.
std::string KeyOf(const PictureRequest& request, const std::string& identity);

}  // namespace skyquilt::tour
