#include "tour/ways/plan_line.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace skyquilt::tour {
namespace {

constexpr double kOrbitStep_rad = std::numbers::pi / 90.0;
constexpr double kShortestRadius_m = 1e-6;  // gives no direction

PlanLine LineThrough(std::vector<Eigen::Vector2d> points) {
  PlanLine line;
  double length = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i > 0) length += (points[i] - points[i - 1]).norm();
    line.lengths_m.push_back(length);
  }
  line.points = std::move(points);
  return line;
}

}  // namespace

Eigen::Vector2d PlanLine::At(double length_m) const {
  // The first point beyond the length.
  const auto beyond = std::upper_bound(lengths_m.begin(), lengths_m.end(), length_m);
  const auto next = static_cast<size_t>(beyond - lengths_m.begin());
  if (next == 0) return points.front();
  if (next == points.size()) return points.back();
  const double u = std::max(0.0, (length_m - lengths_m[next - 1]) / (lengths_m[next] - lengths_m[next - 1]));
  return points[next - 1] + (points[next] - points[next - 1]) * u;
}

PlanLine StraightLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return LineThrough({from.head<2>(), to.head<2>()});
}

PlanLine OrbitLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Eigen::Vector3d& about) {
  const Eigen::Vector2d a = (from - about).head<2>(), b = (to - about).head<2>();
  const double near = a.norm(), far = b.norm();
  // From above the middle one leaves, or gets there, on the bearing of the other end.
  const double angle = near > kShortestRadius_m ? std::atan2(a.y(), a.x()) : std::atan2(b.y(), b.x());
  double turn = near > kShortestRadius_m && far > kShortestRadius_m ? std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) : 0.0;
  if (turn == -std::numbers::pi) turn = std::numbers::pi;
  const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / kOrbitStep_rad)));
  std::vector<Eigen::Vector2d> points = {from.head<2>()};
  for (int i = 1; i < parts; ++i) {
    const double u = static_cast<double>(i) / parts, radius = near + (far - near) * u;
    points.emplace_back(about.x() + radius * std::cos(angle + turn * u), about.y() + radius * std::sin(angle + turn * u));
  }
  points.emplace_back(to.head<2>());
  return LineThrough(std::move(points));
}

}  // namespace skyquilt::tour
