#include "core/render/footprint.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::render {
namespace {

// Of the position's angle about the ray, in sixths of a turn (Zip-NeRF, section 3).
constexpr int kSixths[6] = {0, 2, 4, 3, 5, 1};
// Corners of a tetrahedron: across, across, along.
constexpr int kCorners[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};

}  // namespace

float SharpnessOf(double width_m, double units_per_metre, int points) {
  const double spread = points > 1 ? 3.0 : 1.5;
  return static_cast<float>(std::sqrt(spread) / (width_m * units_per_metre));
}

double TrainedWidth(const TrainedField& f, double width_m) {
  return std::clamp(width_m, f.footprint_min_m, f.footprint_max_m);
}

Turn Turn::Alternating(int index) {
  return index % 2 == 0 ? Turn{} : Turn{std::numbers::pi / 6.0, true};
}

Cone::Cone(const encoding::SpaceMap& map, const Ray& ray, int points) : ray_(map, ray.origin_enu, ray.direction_enu), points_(points) {
  if (ray.pixel_pitch > 0.0F) tip_m_ = static_cast<double>(ray.pixel_width) / static_cast<double>(ray.pixel_pitch);
  const Eigen::Vector3d& d = ray.direction_enu;
  // The axis farthest from the ray.
  Eigen::Index axis = 0;
  d.cwiseAbs().minCoeff(&axis);
  right_ = d.cross(Eigen::Vector3d::Unit(axis)).normalized();
  up_ = right_.cross(d);
}

Eigen::Vector3f Cone::Within(double t, double length_m, double width_m, const Eigen::Vector3d& shares) const {
  const Eigen::Vector3d from_middle = shares.array() - 0.5;
  return ray_.At(t + from_middle.x() * length_m, width_m * (from_middle.y() * right_ + from_middle.z() * up_));
}

void Cone::Positions(double t, double length_m, double width_m, Turn turn, float* x, float* y, float* z, size_t step) const {
  if (points_ == 1) {
    const Eigen::Vector3f p = ray_.At(t);
    *x = p.x();
    *y = p.y();
    *z = p.z();
    return;
  }
  const double cosine = std::cos(turn.angle), sine = std::sin(turn.angle);
  const double from_tip_m = t + tip_m_;
  const auto width_at = [&](double along) { return from_tip_m > 0.0 ? width_m * (1.0 + along / from_tip_m) : width_m; };
  for (int j = 0; j < points_; ++j) {
    double along = 0.0, across_right = 0.0, across_up = 0.0;  // metres, relative to the middle
    if (points_ == 6) {
      const int k = turn.reversed ? 5 - j : j;
      // With these distances the positions have the variance of the interval, and with this radius that of a square of the pixel's width.
      along = 0.5 * length_m * std::sqrt(5.0 / 7.0) * (0.4 * k - 1.0);
      const double angle = std::numbers::pi / 3.0 * kSixths[j];
      const double radius = width_at(along) / std::sqrt(6.0);
      across_right = radius * std::cos(angle);
      across_up = radius * std::sin(angle);
    } else if (points_ == 4) {
      along = 0.5 * length_m / std::sqrt(3.0) * (turn.reversed ? -kCorners[j][2] : kCorners[j][2]);
      const double half = width_at(along) / std::sqrt(12.0);
      across_right = half * kCorners[j][0];
      across_up = half * kCorners[j][1];
    }
    const Eigen::Vector3d beside = (cosine * across_right - sine * across_up) * right_ + (sine * across_right + cosine * across_up) * up_;
    const Eigen::Vector3f p = ray_.At(t + along, beside);
    x[static_cast<size_t>(j) * step] = p.x();
    y[static_cast<size_t>(j) * step] = p.y();
    z[static_cast<size_t>(j) * step] = p.z();
  }
}

}  // namespace skyquilt::render
