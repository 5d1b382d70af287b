#include "core/encoding/space_map.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace skyquilt::encoding {
namespace {

void RequireBox(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu) {
  const bool usable = min_enu.allFinite() && max_enu.allFinite() && ((max_enu - min_enu).array() > 0.0).all();
  if (!usable) throw std::invalid_argument("space map: the box must be finite with positive edges");
}

}  // namespace

SpaceMap SpaceMap::Box(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu) {
  RequireBox(min_enu, max_enu);
  SpaceMap map;
  map.min_enu_ = min_enu;
  map.max_enu_ = max_enu;
  const Eigen::Vector3d size = max_enu - min_enu;
  map.units_per_metre_ = 1.0 / size.maxCoeff();
  map.extent_ = size * map.units_per_metre_;
  return map;
}

SpaceMap SpaceMap::Contracted(const Eigen::Vector3d& min_enu, const Eigen::Vector3d& max_enu) {
  RequireBox(min_enu, max_enu);
  SpaceMap map;
  map.contracted_ = true;
  map.min_enu_ = min_enu;
  map.max_enu_ = max_enu;
  map.centre_ = 0.5 * (min_enu + max_enu).head<2>();
  map.half_size_m_ = 0.5 * (max_enu - min_enu).head<2>().maxCoeff();
  const double height = max_enu.z() - min_enu.z();
  // If the slab is higher than the contracted square is wide, its height determines the unit.
  map.units_per_metre_ = std::min(0.25 / map.half_size_m_, 1.0 / height);
  map.extent_ = Eigen::Vector3d(1.0, 1.0, height * map.units_per_metre_);
  const double across = 0.25 / map.half_size_m_;
  map.inner_volume_scale_ = std::cbrt(across * across * map.units_per_metre_);
  return map;
}

Eigen::Vector3f SpaceMap::UnitFromEnu(const Eigen::Vector3d& x_in_enu) const {
  if (!contracted_) return ((x_in_enu - min_enu_) * units_per_metre_).cast<float>();
  Eigen::Vector2d u = (x_in_enu.head<2>() - centre_) / half_size_m_;
  const double norm = u.cwiseAbs().maxCoeff();
  if (norm > 1.0) u *= (2.0 - 1.0 / norm) / norm;
  return Eigen::Vector3d((u.x() + 2.0) * 0.25, (u.y() + 2.0) * 0.25, (x_in_enu.z() - min_enu_.z()) * units_per_metre_).cast<float>();
}

Eigen::Vector3d SpaceMap::EnuFromUnit(const Eigen::Vector3d& x_in_unit) const {
  if (!contracted_) return min_enu_ + x_in_unit / units_per_metre_;
  Eigen::Vector2d u = x_in_unit.head<2>() * 4.0 - Eigen::Vector2d::Constant(2.0);
  const double norm = std::min(u.cwiseAbs().maxCoeff(), 2.0 - 1e-6);
  if (norm > 1.0) u *= 1.0 / ((2.0 - norm) * norm);
  return {centre_.x() + u.x() * half_size_m_, centre_.y() + u.y() * half_size_m_, min_enu_.z() + x_in_unit.z() / units_per_metre_};
}

Eigen::Matrix3d SpaceMap::UnitPerEnu(const Eigen::Vector3d& x_in_enu) const {
  Eigen::Matrix3d derivative = units_per_metre_ * Eigen::Matrix3d::Identity();
  if (!contracted_) return derivative;
  const Eigen::Vector2d u = (x_in_enu.head<2>() - centre_) / half_size_m_;
  Eigen::Index axis = 0;
  const double norm = u.cwiseAbs().maxCoeff(&axis);
  Eigen::Matrix2d contraction = Eigen::Matrix2d::Identity();
  if (norm > 1.0) {
    contraction *= (2.0 - 1.0 / norm) / norm;
    contraction.col(axis) += 2.0 * (1.0 / norm - 1.0) / (norm * norm) * std::copysign(1.0, u[axis]) * u;
  }
  derivative.topLeftCorner<2, 2>() = 0.25 / half_size_m_ * contraction;
  return derivative;
}

double SpaceMap::VolumeScale(const Eigen::Vector3d& x_in_enu) const {
  if (!contracted_) return units_per_metre_;
  const double norm = std::max(1.0, ((x_in_enu.head<2>() - centre_) / half_size_m_).cwiseAbs().maxCoeff());
  return norm > 1.0 ? inner_volume_scale_ * std::cbrt((2.0 * norm - 1.0) / norm) / norm : inner_volume_scale_;
}

double SpaceMap::LocalScale(const Eigen::Vector3d& x_in_enu) const {
  if (!contracted_) return 1.0;
  const double norm = ((x_in_enu.head<2>() - centre_) / half_size_m_).cwiseAbs().maxCoeff();
  return norm <= 1.0 ? 1.0 : 1.0 / (norm * norm);
}

}  // namespace skyquilt::encoding
