// The surface that a volume is measured against, when it is a plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/render/ray.h"
#include "viewer/queries/field_rays.h"

namespace skyquilt::viewer {

// z = middle height + slope . (place - middle).
struct BasePlane {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double height_m = 0.0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double sigma_m = 0.0;  // one standard deviation of its height at the polygon's centroid, which is its mean height; NaN: unknown

  double At(const Eigen::Vector2d& place) const { return height_m + slope.dot(place - middle); }
};

// The surface at the corners of a polygon. A click is not exact and a single ray may hit a blade of grass, so each corner is the median of a small
// patch around it.
class CornerPatches {
 public:
  // spacing_m: between the rays of a patch.
  CornerPatches(const std::vector<Eigen::Vector2d>& polygon, double spacing_m);

  size_t rays() const;
  Eigen::Vector2d Place(size_t ray) const;
  // NaN: no surface there.
  void Take(size_t ray, double height_m, double spread_m);

  // Least squares through the corners. Throws BadMessage when fewer than three corners have a surface, or they lie on a line.
  BasePlane FitPlane(const Eigen::Vector2d& centroid) const;
  // Horizontal, through the lowest corner. Throws BadMessage when no corner has a surface.
  BasePlane Lowest() const;

 private:
  struct Corner {
    Eigen::Vector2d place;
    double height_m = 0.0, spread_m = 0.0;
  };
  // Those that have a surface.
  std::vector<Corner> Corners() const;

  std::vector<Eigen::Vector2d> polygon_;
  double spacing_m_;
  std::vector<double> heights_m_, spreads_m_;
};

}  // namespace skyquilt::viewer
