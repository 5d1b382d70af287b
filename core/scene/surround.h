// Pictures for people: where no training photo looked, a scene shows what its fields and its background happen to extrapolate, such as stripes to the
// horizon and fog at the border. This shows a plain ground, a haze and a sky there instead. Scores and maps do not use it.
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/render/ray.h"
#include "core/scene/background.h"

namespace skyquilt::scene {

// Keeps a reference to the background, which must outlive it. Positions are survey ENU, metres; colours display values at reference exposure.
class Surround {
 public:
  explicit Surround(const Background& background);

  // From 0, where at most one training photo shows the ground, to 1, where three or more do, without a step. Where the background does not say how
  // many (photos that look level, scenes of older programs), 1 within its height map. 0 beyond the map; 1 everywhere without a map.
  double SeenShare(const Eigen::Vector2d& x_enu) const;
  // Of a ray that meets no field: the background's where photos looked, else plain.
  std::array<float, 3> Behind(const Eigen::Vector3d& origin_enu, const Eigen::Vector3d& direction_enu) const;
  // Takes off from colour (premultiplied) and opacity of a ray that met fields what no photo confirms; nothing where the background does not say how
  // many photos see the ground. Depths stay.
  void Fade(const render::Ray& ray, render::RayColor* color) const;

 private:
  std::array<float, 3> PlainGround(const Eigen::Vector3d& x_enu, const Eigen::Vector3d& direction_enu) const;
  std::array<float, 3> Sky(const Eigen::Vector3d& direction_enu) const;
  double DistanceOutside(const Eigen::Vector2d& x_enu) const;  // from the height map's rectangle, metres; 0 within

  const Background& background_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero(), high_ = Eigen::Vector2d::Zero();  // of the height map
  double haze_m_ = 1.0;  // distance from the map in which all but 1/e of the ground's colour is haze
};

}  // namespace skyquilt::scene
