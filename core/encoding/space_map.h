// Maps survey ENU metres to the unit box in which a field is evaluated. Computed in double and rounded to float once.
//   Box:   for blocks. x_unit = (x - min) / longest edge; the box maps to [0, extent].
//   Slab:  for the context, which covers all distances. Heights are mapped linearly. Let u be the horizontal position relative to the survey, -1 to 1
//          inside its square. Inside, u is kept; outside it is contracted to u (2 - 1/|u|) / |u| (mip-NeRF 360, eq. 10, max norm over x and y).
//          The contracted square [-2, 2] maps to [0, 1].
#pragma once

#include <Eigen/Core>

namespace skyquilt::encoding {

class SpaceMap {
 public:
  SpaceMap() = default;
  static SpaceMap Box(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu);
  static SpaceMap Contracted(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu);

  bool contracted() const { return contracted_; }
  const Eigen::Vector3d& min_enu() const { return min_enu_; }
  const Eigen::Vector3d& max_enu() const { return max_enu_; }
  // Edges of the unit box; the longest is 1.
  const Eigen::Vector3d& extent() const { return extent_; }
  // Unit lengths per metre where space is not contracted.
  double units_per_metre() const { return units_per_metre_; }

  Eigen::Vector3f UnitFromEnu(const Eigen::Vector3d& x_in_enu) const;
  Eigen::Vector3d EnuFromUnit(const Eigen::Vector3d& x_in_unit) const;
  // Derivative of UnitFromEnu by position, 1/m: column j is the change per metre along axis j. A gradient in the unit frame times it (transposed) is
  // the gradient in ENU.
  Eigen::Matrix3d UnitPerEnu(const Eigen::Vector3d& x_in_enu) const;
  // Cube root of the volume that a cubic metre here has in the unit frame. Without contraction units_per_metre(). Contraction with u as above divides
  // volumes by |u|^4 / (2 |u| - 1) (Zip-NeRF, Barron et al. 2023, scales footprints in this way).
  double VolumeScale(const Eigen::Vector3d& x_in_enu) const;
  // Length of a radial metre here relative to one in the uncontracted part, in (0, 1].
  double LocalScale(const Eigen::Vector3d& x_in_enu) const;

 private:
  bool contracted_ = false;
  Eigen::Vector3d min_enu_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_enu_ = Eigen::Vector3d::Ones();
  Eigen::Vector3d extent_ = Eigen::Vector3d::Ones();
  Eigen::Vector2d centre_ = Eigen::Vector2d::Zero();  // Slab only
  double half_size_m_ = 1.0;                          // Slab only
  double units_per_metre_ = 1.0;
  double inner_volume_scale_ = 1.0;  // VolumeScale where space is not contracted; slab only
};

}  // namespace skyquilt::encoding
