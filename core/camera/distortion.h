// Applies and inverts lens distortion, between ideal (pinhole) and distorted points (COLMAP src/colmap/sensor/models.h, OpenCV calib3d). A point (u,
// v) is on the plane of its kind, r its distance from the axis, s = r^2:
//   perspective: the plane z = 1; radial factor (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3)
//   field of view: the plane z = 1; distorted radius atan(2 r tan(omega / 2)) / omega (Devernay and Faugeras 2001)
//   fisheye: the point with r = theta, the angle from the axis; radial factor 1 + k1 s + k2 s^2 + ... + k6 s^6
// Then, with a = the same point (after the radial factor where `sequential`) and t = |a|^2, a shift of the distorted point by
//   2 p1 a_u a_v + p2 (t + 2 a_u^2) + q1 t + q2 t^2   and   2 p2 a_u a_v + p1 (t + 2 a_v^2) + q3 t + q4 t^2
// (tangential and thin prism). All are used only up to the first fold, the radius where the distorted radius stops growing: beyond it the polynomials
// do not describe the lens.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "core/camera/camera.h"

namespace skyquilt::camera {

// The shift that is not radial.
struct Decentering {
  double p1 = 0.0;
  double p2 = 0.0;
  std::array<double, 4> prism{};  // q1 to q4
  bool sequential = false;        // of the radially distorted point

  bool IsZero() const { return p1 == 0.0 && p2 == 0.0 && prism == std::array<double, 4>{}; }
};

class Distortion {
 public:
  static Distortion Perspective(const std::array<double, 6>& k, double p1, double p2) { return {Kind::kPerspective, k, {p1, p2, {}, false}}; }
  static Distortion Fisheye(const std::array<double, 6>& k, const Decentering& shift = {}) { return {Kind::kFisheye, k, shift}; }
  // omega in radians, between -pi and pi; 0 is no distortion.
  static Distortion FieldOfView(double omega) { return {Kind::kFieldOfView, {omega}, {}}; }

  // Distorted point of a direction with z > 0; nothing beyond the first fold.
  std::optional<Eigen::Vector2d> Distort(const Eigen::Vector3d& direction) const;
  // Unit direction of a distorted point; beyond the image of the first fold the nearest direction found; never NaN.
  Eigen::Vector3d Undistort(const Eigen::Vector2d& distorted) const;
  // Distorted point of a point on the plane of this kind, with its derivatives where `jacobian` is not null. Does not look for folds.
  Eigen::Vector2d DistortPlane(const Eigen::Vector2d& ideal, Eigen::Matrix2d* jacobian) const;

 private:
  enum class Kind { kPerspective, kFieldOfView, kFisheye };

  Distortion(Kind kind, const std::array<double, 6>& k, const Decentering& shift)
      : kind_(kind), is_ideal_(kind != Kind::kFisheye && k == std::array<double, 6>{} && shift.IsZero()), k_(k), shift_(shift) {}

  // A value and its derivative.
  struct Jet {
    double value;
    double slope;
  };
  // By s.
  Jet RadialFactor(double s) const;
  // Distorted radius as a function of the ideal radius (fisheye: the angle), without the shift.
  Jet Profile(double r) const;
  // Largest ideal radius that is looked at.
  double Limit() const;
  // True when the profile grows everywhere from the centre to r.
  bool GrowsUpTo(double r) const;
  // Inverse of the profile up to its first fold; the radius of the fold when the distorted radius is larger than any there.
  double InvertProfile(double distorted_radius) const;
  double InvertProfileSlowly(double distorted_radius) const;

  // The point times the factor, plus the shift of the point.
  Eigen::Vector2d WithShift(const Eigen::Vector2d& point, const Jet& factor, Eigen::Matrix2d* jacobian) const;
  Eigen::Vector2d UndistortPlane(const Eigen::Vector2d& distorted) const;

  Kind kind_;
  bool is_ideal_;
  std::array<double, 6> k_;  // of the field of view: omega
  Decentering shift_;
};

// What a camera's pixels need to become rays, looked up once: for loops over many pixels of one camera.
class Lens {
 public:
  explicit Lens(const Camera& camera)
      : distortion_(DistortionOf(camera)), focal_(camera.FocalX(), camera.FocalY()), principal_point_(camera.PrincipalPoint()) {}

  // As Camera::RayFromImg, with the same bits.
  Eigen::Vector3d RayFromImg(const Eigen::Vector2d& pixel) const { return distortion_.Undistort((pixel - principal_point_).cwiseQuotient(focal_)); }

 private:
  Distortion distortion_;
  Eigen::Vector2d focal_;
  Eigen::Vector2d principal_point_;
};

}  // namespace skyquilt::camera
