#include "prepare/georeference/stated_up.h"

#include "core/base/errors.h"
#include "prepare/georeference/camera_up.h"
#include "prepare/georeference/number_list.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr const char* kByCameras = "cameras";

Eigen::Vector3d ParseUp(const std::string& text) {
  const std::optional<Eigen::Vector3d> up = ParseVector(text, ',');
  if (!up || !(up->norm() > 0.0)) {
    throw base::UsageError("prepare.up = '" + text +
                           "' (--up) is not allowed: it must be cameras, or the direction of up in the frame of the camera model as three numbers "
                           "x,y,z that are not all 0, such as 0,0,1");
  }
  return up->normalized();
}

}  // namespace

void CheckUpOption(const std::string& text) {
  if (!text.empty() && text != kByCameras) ParseUp(text);
}

std::optional<Eigen::Vector3d> StatedUp(const std::string& text, const std::vector<input::PreparedPhoto>& photos) {
  if (text.empty()) return std::nullopt;
  if (text != kByCameras) return ParseUp(text);
  const Eigen::Vector3d up = MeanCameraUp(photos);
  constexpr double kLeast = 0.1;
  if (!(up.norm() > kLeast)) {
    throw base::UsageError(
        "prepare.up = cameras (--up): the up directions of the photos cancel, as of photos that look straight down. Leave the option out, or give "
        "the "
        "direction of up in the frame of the camera model as x,y,z, and add --restart");
  }
  return up.normalized();
}

}  // namespace skyquilt::prepare::georeference
