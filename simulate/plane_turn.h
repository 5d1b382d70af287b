// Turn of the plane (east, north) about a point, for city plans that are laid out along straight axes first. A turn by 0 degrees changes no bit as
// long as the point is the origin.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace skyquilt::simulate {

class PlaneTurn {
 public:
  PlaneTurn() = default;
  // Counter-clockwise.
  PlaneTurn(const Eigen::Vector2d& about, double turn_deg)
      : about_(about), cosine_(std::cos(turn_deg * std::numbers::pi / 180.0)), sine_(std::sin(turn_deg * std::numbers::pi / 180.0)), deg_(turn_deg) {}

  Eigen::Vector2d Turned(const Eigen::Vector2d& point) const { return about_ + TurnedDirection(point - about_); }
  Eigen::Vector2d TurnedBack(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d d = point - about_;
    return about_ + Eigen::Vector2d(cosine_ * d.x() + sine_ * d.y(), cosine_ * d.y() - sine_ * d.x());
  }
  Eigen::Vector2d TurnedDirection(const Eigen::Vector2d& d) const { return {cosine_ * d.x() - sine_ * d.y(), cosine_ * d.y() + sine_ * d.x()}; }
  // A yaw counter-clockwise from east, degrees; -180..180 after a turn.
  double TurnedYaw(double yaw_deg) const { return deg_ == 0.0 ? yaw_deg : std::remainder(yaw_deg + deg_, 360.0); }
  const Eigen::Vector2d& about() const { return about_; }
  double cosine() const { return cosine_; }
  double sine() const { return sine_; }

 private:
  Eigen::Vector2d about_ = Eigen::Vector2d::Zero();
  double cosine_ = 1.0;
  double sine_ = 0.0;
  double deg_ = 0.0;
};

// Of a point to a rectangle of these half sizes about the origin, along the axes; negative inside.
inline double DistanceToRectangle(const Eigen::Vector2d& point, const Eigen::Vector2d& half) {
  const Eigen::Vector2d out = point.cwiseAbs() - half;
  return out.cwiseMax(0.0).norm() + std::min(out.maxCoeff(), 0.0);
}

}  // namespace skyquilt::simulate
