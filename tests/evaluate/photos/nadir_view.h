// A camera that looks straight down, for tests of what it sees.
#pragma once

#include "evaluate/photos/coverage.h"

namespace skyquilt::evaluate::photos {

// From (x, y, height): image x east, image y south, 100 x 80 pixels. From 100 m up, a pixel is a metre of ground.
inline TrainingView NadirView(double x, double y, double height_m) {
  TrainingView view;
  view.camera.model = camera::CameraModel::kPinhole;
  view.camera.width = 100;
  view.camera.height = 80;
  view.camera.params = {100.0, 100.0, 50.0, 40.0};
  Eigen::Matrix3d rotation;
  rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  view.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
  view.cam_from_enu.translation = -(rotation * Eigen::Vector3d(x, y, height_m));
  return view;
}

}  // namespace skyquilt::evaluate::photos
