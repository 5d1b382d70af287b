// Which way is up by how the cameras were held. People and gimbals hold cameras level: the right axis of a photo is horizontal, or, where the camera
// was turned by a quarter and no tag says so, its other axis. This gives the line of up where photos look in different directions, and the photos'
// own up gives its sign. Cameras that all look the same way look straight down or at a wall, and their axes are the same in both: then the tagged
// positions, small turns of the cameras and the way they moved tell the two apart.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <vector>

#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

// The direction of up by a fit to the tagged positions alone, a unit vector in the model's frame; nothing when they do not determine it.
using UpByTagsFunction = std::function<std::optional<Eigen::Vector3d>()>;

struct HeldCameras {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  // unit vector in the model's frame
  // Per photo, of the camera as it shows the photo upright: x right, y down. Those of unturned photos are the photos' own.
  std::vector<Eigen::Quaterniond> cam_from_model = {};
};

// `tags_up` is asked for only when all cameras look about the same way; may be empty.
HeldCameras FindHeldCameras(const std::vector<input::PreparedPhoto>& photos, const UpByTagsFunction& tags_up);

// Mean of the photos' own up, turned as their EXIF orientation says, in the model's frame; its length is 1 when all agree, 0 when they cancel.
Eigen::Vector3d MeanCameraUp(const std::vector<input::PreparedPhoto>& photos);

}  // namespace skyquilt::prepare::georeference
