// Photos that look straight down or level, for surveys in tests.
#pragma once

#include <cmath>
#include <string>

#include "core/survey/survey.h"

namespace skyquilt {

// `eye`: camera centre in ENU, metres. Camera x = east, y = south, z = down.
inline survey::Photo NadirPhoto(const Eigen::Vector3d& eye, const std::string& name) {
  survey::Photo photo;
  photo.name = name;
  Eigen::Matrix3d rotation;
  rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  photo.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
  photo.cam_from_enu.translation = -(rotation * eye);
  photo.agl_m = std::nan("");
  return photo;
}

// One that looks level to the north: camera x = east, y = down, z = north.
inline survey::Photo LevelPhoto(const Eigen::Vector3d& eye, const std::string& name) {
  survey::Photo photo = NadirPhoto(eye, name);
  Eigen::Matrix3d rotation;
  rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  photo.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
  photo.cam_from_enu.translation = -(rotation * eye);
  return photo;
}

}  // namespace skyquilt
