// Ground that the user wants to be ignored, such as a lake or a motorway, and the pixels of photos that show it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/geo/transform.h"
#include "core/gis/boundary.h"
#include "core/image/image.h"
#include "core/scene/height_map.h"
#include "core/survey/survey.h"

namespace skyquilt::masks {

// Immutable, so usable by several threads.
class IgnoredGround {
 public:
  // Reads the polygons (gis::Boundary::Read) and makes heights of the survey's sparse points (scene/point_heights.h). Where the points leave gaps, as
  // on water, these are filled from around. Throws base::InputError: a file that cannot be used, polygons that do not meet the ground that the photos
  // see, a survey without sparse points.
  IgnoredGround(const survey::Survey& survey, const std::filesystem::path& polygons);

  // Rings around the ignored ground near the survey: x and y in ENU metres, even-odd rule.
  const std::vector<std::vector<Eigen::Vector2d>>& rings() const { return inside_.rings(); }
  // Changes with rings and heights; 16 hexadecimal digits.
  const std::string& Key() const { return key_; }
  // 0 where the ray through a pixel's centre meets the heights on ignored ground, else 255. Size: that of the camera; its sides may differ from
  // those of the photo. Nearly level and rising rays meet no ground.
  image::Image8 Mask(const camera::Camera& camera, const geo::Rigid3d& cam_from_enu) const;

 private:
  scene::HeightMap heights_;
  gis::Boundary inside_{{}};  // in ENU
  std::string key_;
};

}  // namespace skyquilt::masks
