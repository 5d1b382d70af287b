// The plane through heights of cells, by least squares.
#pragma once

#include <cstddef>

namespace skyquilt::surface {

struct Plane {
  double x0 = 0.0, y0 = 0.0, z0 = 0.0;  // a point of it
  double dx = 0.0, dy = 0.0;            // slope along each axis
  double At(double x, double y) const { return z0 + dx * (x - x0) + dy * (y - y0); }
};

class PlaneFit {
 public:
  // The middle of the values to come, so that sums of squares do not lose digits.
  PlaneFit(double middle_x, double middle_y) : x0_(middle_x), y0_(middle_y) {}

  void Add(double x, double y, double z) {
    const double u = x - x0_, v = y - y0_;
    n_ += 1.0;
    u_ += u;
    v_ += v;
    z_ += z;
    uu_ += u * u;
    uv_ += u * v;
    vv_ += v * v;
    uz_ += u * z;
    vz_ += v * z;
  }
  // Level where the values do not determine a slope; zero without values.
  Plane Fit() const {
    if (n_ == 0.0) return {x0_, y0_, 0.0, 0.0, 0.0};
    Plane plane{x0_ + u_ / n_, y0_ + v_ / n_, z_ / n_, 0.0, 0.0};
    const double uu = uu_ - u_ * u_ / n_, uv = uv_ - u_ * v_ / n_, vv = vv_ - v_ * v_ / n_;
    const double uz = uz_ - u_ * z_ / n_, vz = vz_ - v_ * z_ / n_;
    const double determinant = uu * vv - uv * uv;
    if (determinant > 1e-9 * (uu + vv) * (uu + vv)) {
      plane.dx = (uz * vv - vz * uv) / determinant;
      plane.dy = (vz * uu - uz * uv) / determinant;
    }
    return plane;
  }

 private:
  double x0_, y0_;
  double n_ = 0.0, u_ = 0.0, v_ = 0.0, z_ = 0.0, uu_ = 0.0, uv_ = 0.0, vv_ = 0.0, uz_ = 0.0, vz_ = 0.0;
};

}  // namespace skyquilt::surface
