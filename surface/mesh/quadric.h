// Mean squared distance to a set of planes, weighted by area (Garland and Heckbert 1997).
#pragma once

#include <Eigen/Core>

namespace skyquilt::surface {

class Quadric {
 public:
  // The plane through `point` with this normal of length 1.
  void AddPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point, double weight) {
    const double d = -normal.dot(point);
    xx_ += weight * normal.x() * normal.x();
    xy_ += weight * normal.x() * normal.y();
    xz_ += weight * normal.x() * normal.z();
    yy_ += weight * normal.y() * normal.y();
    yz_ += weight * normal.y() * normal.z();
    zz_ += weight * normal.z() * normal.z();
    linear_ += weight * d * normal;
    constant_ += weight * d * d;
    weight_ += weight;
  }
  void Add(const Quadric& other) {
    xx_ += other.xx_;
    xy_ += other.xy_;
    xz_ += other.xz_;
    yy_ += other.yy_;
    yz_ += other.yz_;
    zz_ += other.zz_;
    linear_ += other.linear_;
    constant_ += other.constant_;
    weight_ += other.weight_;
  }
  // Square metres; 0 without planes, NaN when a plane was not finite.
  double MeanSquare(const Eigen::Vector3d& x) const {
    if (weight_ == 0.0) return 0.0;
    const double quadratic =
        x.x() * (xx_ * x.x() + 2.0 * (xy_ * x.y() + xz_ * x.z())) + x.y() * (yy_ * x.y() + 2.0 * yz_ * x.z()) + zz_ * x.z() * x.z();
    const double sum = quadratic + 2.0 * linear_.dot(x) + constant_;
    return sum < 0.0 ? 0.0 : sum / weight_;  // keeps NaN
  }

 private:
  double xx_ = 0.0, xy_ = 0.0, xz_ = 0.0, yy_ = 0.0, yz_ = 0.0, zz_ = 0.0;
  Eigen::Vector3d linear_ = Eigen::Vector3d::Zero();
  double constant_ = 0.0, weight_ = 0.0;
};

}  // namespace skyquilt::surface
