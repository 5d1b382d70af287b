// The numbers of a shape as one vector, in the order of FittedShape::covariance without the ground, followed by two that belong to the fit only.
#pragma once

#include <Eigen/Core>

#include "buildings/building.h"

namespace skyquilt::buildings {

class Parameters {
 public:
  explicit Parameters(const Shape& shape);

  int yaw() const { return 0; }
  int line(int axis, int i) const { return 1 + (axis == 0 ? 0 : lines_u_) + i; }
  int eave(int part) const { return eave_[static_cast<size_t>(part)]; }
  // The same as eave for roofs of one height.
  int ridge(int part) const { return ridge_[static_cast<size_t>(part)]; }
  int shape_size() const { return shape_size_; }
  // How far the edges of pitched and of flat roofs reach over the walls.
  int overhang(bool pitched) const { return shape_size_ + (pitched ? 0 : 1); }
  int size() const { return shape_size_ + 2; }

  // The parameters of a shape with the same lines and parts; those of the fit only are 0.
  Eigen::VectorXd Of(const Shape& shape) const;
  void Set(const Eigen::VectorXd& values, Shape* shape) const;

 private:
  int lines_u_ = 0, shape_size_ = 0;
  std::vector<int> eave_, ridge_;
};

inline bool IsPitched(const Part& part) {
  return part.roof == RoofKind::kGable || part.roof == RoofKind::kHip;
}

}  // namespace skyquilt::buildings
