#include "tour/ways/route.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tour/ways/look_along.h"
#include "tour/ways/plan_line.h"
#include "tour/ways/profile.h"

namespace skyquilt::tour {
namespace {

constexpr double kShortest_s = 1.5;
constexpr double kLongest_s = 12.0;  // longer only by the time that turning takes
constexpr double kFastestTurn_deg_per_s = 60.0, kFastestZoom_deg_per_s = 30.0;
constexpr double kLeast_s = 1e-6;  // what takes less is rounding
constexpr double kSecondsPerRootMetre = 0.9;
constexpr double kEasePeak = 1.5;  // greatest speed by mean speed of the easing
constexpr int kNodes = 96;

double TurnBetween_deg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  const Eigen::Quaterniond d = a.conjugate() * b;
  return 2.0 * std::atan2(d.vec().norm(), std::abs(d.w())) * 180.0 / std::numbers::pi;
}

// Corners of the way: those of its plan and those of its profile.
std::vector<Eigen::Vector3d> CornersAlong(const PlanLine& line, const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Heights* heights,
                                          bool over) {
  const std::vector<Eigen::Vector2d> profile = ProfileAlong(line, from.z(), to.z(), heights, over);
  std::vector<Eigen::Vector3d> points;
  size_t next = 0;
  for (size_t i = 0; i < profile.size(); ++i) {
    const double at = profile[i].x(), z = profile[i].y();
    const Eigen::Vector2d before = i > 0 ? profile[i - 1] : Eigen::Vector2d(0.0, z);
    // Corners in plan since the last one of the profile.
    for (; next < line.points.size() && line.lengths_m[next] < at; ++next) {
      const double corner = line.lengths_m[next];
      if (corner <= before.x()) continue;
      points.emplace_back(line.points[next].x(), line.points[next].y(), before.y() + (z - before.y()) * (corner - before.x()) / (at - before.x()));
    }
    const Eigen::Vector2d x = line.At(at);
    points.emplace_back(x.x(), x.y(), z);
  }
  points.front() = from;
  points.back() = to;
  return points;
}

// Points of the way close enough together that the view turns little between them.
std::vector<WayPlace> PlacesAlong(const std::vector<Eigen::Vector3d>& points, double length_m) {
  std::vector<WayPlace> places;
  if (!(length_m > 0.0)) {
    // Turning on the spot.
    for (int i = 0; i <= kNodes; ++i) places.push_back({points.front(), static_cast<double>(i) / kNodes});
    return places;
  }
  places.push_back({points.front(), 0.0});
  double done = 0.0;
  for (size_t i = 1; i < points.size(); ++i) {
    const double piece = (points[i] - points[i - 1]).norm();
    const int parts = std::max(1, static_cast<int>(std::ceil(kNodes * piece / length_m)));
    for (int k = 1; k <= parts; ++k) {
      const Eigen::Vector3d eye = k == parts ? points[i] : Eigen::Vector3d(points[i - 1] + (points[i] - points[i - 1]) * k / parts);
      places.push_back({eye, std::min(1.0, (done + piece * k / parts) / length_m)});
    }
    done += piece;
  }
  return places;
}

}  // namespace

Route::Route(const Pose& from, const Pose& to, const Path& path, const Heights* heights) : from_(from), to_(to) {
  if (path.kind == PathKind::kJump) return;
  const bool orbit = path.kind == PathKind::kOrbit;
  const PlanLine line = orbit ? OrbitLine(from.eye_enu, to.eye_enu, path.about) : StraightLine(from.eye_enu, to.eye_enu);
  const std::vector<Eigen::Vector3d> corners = CornersAlong(line, from.eye_enu, to.eye_enu, heights, path.kind == PathKind::kOver);
  double length = 0.0;
  for (size_t i = 1; i < corners.size(); ++i) length += (corners[i] - corners[i - 1]).norm();
  const std::vector<WayPlace> places = PlacesAlong(corners, length);
  const auto rotations = RotationsAlong(places, from, to, orbit && length > 0.0 ? std::optional(path.about) : std::nullopt);
  const double travel_s = std::min(kLongest_s, kShortest_s + kSecondsPerRootMetre * std::sqrt(length));
  for (size_t i = 0; i < places.size(); ++i) {
    Node node;
    node.pose = {places[i].eye_enu, rotations[i], from.fovy_deg + (to.fovy_deg - from.fovy_deg) * places[i].share};
    if (i > 0) {
      const Node& before = nodes_.back();
      const double travel = length > 0.0 ? (places[i].share - places[i - 1].share) * travel_s : 0.0;
      const double turn = kEasePeak * TurnBetween_deg(before.pose.cam_from_enu, node.pose.cam_from_enu) / kFastestTurn_deg_per_s;
      const double zoom = kEasePeak * (node.pose.fovy_deg - before.pose.fovy_deg) / kFastestZoom_deg_per_s;
      node.time_s = before.time_s + std::sqrt(travel * travel + turn * turn + zoom * zoom);
    }
    nodes_.push_back(node);
  }
  if (nodes_.back().time_s < kLeast_s) {
    nodes_.clear();
    return;
  }
  length_m_ = length;
  duration_s_ = std::max(kShortest_s, nodes_.back().time_s);
}

Pose Route::At(double seconds) const {
  if (seconds >= duration_s_) return to_;
  if (!(seconds > 0.0)) return from_;
  const double u = seconds / duration_s_, time_s = u * u * (3.0 - 2.0 * u) * nodes_.back().time_s;
  // The last node that is not later, with one behind it.
  const auto later = std::upper_bound(nodes_.begin() + 1, nodes_.end() - 1, time_s, [](double t, const Node& node) { return t < node.time_s; });
  const Node &a = *(later - 1), &b = *later;
  const double part = b.time_s > a.time_s ? std::clamp((time_s - a.time_s) / (b.time_s - a.time_s), 0.0, 1.0) : 1.0;
  return {.eye_enu = a.pose.eye_enu + (b.pose.eye_enu - a.pose.eye_enu) * part,
          .cam_from_enu = a.pose.cam_from_enu.slerp(part, b.pose.cam_from_enu),
          .fovy_deg = a.pose.fovy_deg + (b.pose.fovy_deg - a.pose.fovy_deg) * part};
}

}  // namespace skyquilt::tour
