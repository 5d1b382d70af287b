// Applies and inverts lens distortion, between ideal (pinhole) and distorted points on the plane z = 1 (COLMAP src/colmap/sensor/models.h, OpenCV
// calib3d).
//   perspective: radial factor (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3), s = r^2, plus tangential p1, p2
//   fisheye:     theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), theta the angle from the axis
// Both are used only up to the first fold, the radius where the distorted radius stops growing: beyond it the polynomials do not describe the lens.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace skyquilt::camera {

class Distortion {
 public:
  static Distortion Perspective(const std::array<double, 6>& k, double p1, double p2) { return {false, k, p1, p2}; }
  static Distortion Fisheye(double k1, double k2, double k3, double k4) { return {true, {k1, k2, k3, k4, 0.0, 0.0}, 0.0, 0.0}; }

  // Distorted point of a direction with z > 0; nothing beyond the first fold.
  std::optional<Eigen::Vector2d> Distort(const Eigen::Vector3d& direction) const;
  // Unit direction of a distorted point; beyond the image of the first fold the nearest direction found; never NaN.
  Eigen::Vector3d Undistort(const Eigen::Vector2d& distorted) const;

 private:
  Distortion(bool is_fisheye, const std::array<double, 6>& k, double p1, double p2)
      : is_fisheye_(is_fisheye), is_ideal_(!is_fisheye && k == std::array<double, 6>{} && p1 == 0.0 && p2 == 0.0), k_(k), p1_(p1), p2_(p2) {}

  // A value and its derivative.
  struct Jet {
    double value;
    double slope;
  };
  Jet RadialFactor(double s) const;
  // Distorted radius as a function of the ideal radius (perspective) or angle (fisheye), without the tangential part.
  Jet Profile(double r) const;
  // True when the profile grows everywhere from the centre to r.
  bool GrowsUpTo(double r) const;
  // Inverse of the profile up to its first fold; the radius of the fold when the distorted radius is larger than any there.
  double InvertProfile(double distorted_radius) const;
  double InvertProfileSlowly(double distorted_radius) const;

  Eigen::Vector2d DistortPlane(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const;
  Eigen::Vector2d UndistortPlane(const Eigen::Vector2d& distorted) const;

  bool is_fisheye_;
  bool is_ideal_;
  std::array<double, 6> k_;
  double p1_;
  double p2_;
};

}  // namespace skyquilt::camera
