// Where photos were taken and what they look at, by their tags alone: enough to tell which of them may show the same ground.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::poses {

// In metres; x east, y north about a tagged position.
struct PhotoPlace {
  Eigen::Vector2d camera = Eigen::Vector2d::Zero();
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  // the ground in the middle of the photo; below the camera where the direction is not known
  // Unit vector of the viewing direction (east, north, up) times the survey's median height above ground: photos that see the same ground from other
  // directions are as different as photos from that far away.
  Eigen::Vector3d view = Eigen::Vector3d::Zero();
};

// Empty for a photo without a position. All are empty when positions do not tell photos apart: there are fewer that are 0.5 m from each other,
// heights included, than half as many as shots with a tag (input/shots.h). The direction counts for photos with gimbal angles and height above
// take-off; no directions are used when the yaw of all oblique photos is the same number, which is how some programs write "unknown". Anywhere on
// Earth.
std::vector<std::optional<PhotoPlace>> FindPlaces(const std::vector<input::PhotoFile>& photos);

// Whether directions moved any target away from its camera.
bool HasObliquePhotos(const std::vector<std::optional<PhotoPlace>>& places);

}  // namespace skyquilt::prepare::poses
