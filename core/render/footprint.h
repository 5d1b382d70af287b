// Footprints of samples. A pixel sees a cone: the sample at distance t stands for a piece of space as wide as the pixel there and as long as its
// interval, and features of the hash grid that are finer than this width fade (kernel::FootprintWeight).
//   One position per sample: the middle. Its footprint is a normal distribution with the variance of a square of the pixel's width, so the weight is
//   erf(sqrt(3/2) voxel / width).
//   Four or six positions: together they have the mean and the variances of the piece of space, so directions across the ray are seen apart. Weight
//   erf(sqrt(3) voxel / width) (Barron et al. 2023, Zip-NeRF, section 3: six positions on a hexagonal spiral). Four are the corners of a tetrahedron.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "core/render/march.h"
#include "core/render/ray.h"
#include "core/render/trained_field.h"

namespace skyquilt::render {

// Positions per sample are 1, 4 or 6.
constexpr int kMaxPositions = 6;

// kernel::Positions::sharpness of a footprint of this width, in 1 / unit length. Infinite for width 0.
float SharpnessOf(double width_m, double units_per_metre, int points);

// The range of widths with which a field was trained. Others count as at its ends: the networks have never seen them.
double TrainedWidth(const TrainedField& f, double width_m);

// How the positions of a sample are turned about its ray, and whether their order along the ray is reversed: at random in training, alternating in
// renderings, so that neighbouring samples see different places.
struct Turn {
  double angle = 0.0;  // radians
  bool reversed = false;

  // For the index-th sample of a rendered ray.
  static Turn Alternating(int index);
};

// The cone of a ray in a field's unit frame. The map and the ray must outlive it.
class Cone {
 public:
  Cone(const encoding::SpaceMap& map, const Ray& ray, int points);

  // Writes `points` positions in the unit frame, `step` floats apart, of the sample in the middle of an interval of `length_m` at distance t.
  // width_m: of the cone at t; positions before and behind the middle take their share of it. Not finite for an infinite width.
  void Positions(double t, double length_m, double width_m, Turn turn, float* x, float* y, float* z, size_t step) const;
  // One position in the unit frame within that piece of space. shares: along the ray and twice across it, 0 to 1.
  Eigen::Vector3f Within(double t, double length_m, double width_m, const Eigen::Vector3d& shares) const;

 private:
  UnitRay ray_;
  int points_;
  double tip_m_ = std::numeric_limits<double>::infinity();  // from the origin back to where the width is 0; infinite for columns
  Eigen::Vector3d right_ = Eigen::Vector3d::Zero(), up_ = Eigen::Vector3d::Zero();  // across the ray, ENU, length 1
};

}  // namespace skyquilt::render
