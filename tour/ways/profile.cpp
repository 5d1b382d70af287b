#include "tour/ways/profile.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "tour/ways/clearance.h"

namespace skyquilt::tour {
namespace {

using Points = std::vector<Eigen::Vector2d>;
using IsClear = std::function<bool(const Eigen::Vector2d&, const Eigen::Vector2d&)>;

// The string is pulled this much higher than the barriers, so that corners can be rounded below it. Less near the ends, which stay where they are.
constexpr double kLift_m = 0.5, kLiftFullAfter_m = 4.0;
constexpr double kRisenAt = 0.25;  // where a way over the highest has reached its height
constexpr double kLeastCorner_rad = std::numbers::pi / 180.0;
constexpr int kRoundings = 7;
constexpr double kLeastRounding_m = 0.05;
constexpr double kRoundStep_rad = std::numbers::pi / 36.0;

double LiftedOver(double z, const Barrier* barrier) {
  return barrier == nullptr || barrier->z <= z ? z : barrier->z + kLift_m;
}

// From end to end above all barriers, as short as possible: it bends only downwards, so it is a convex hull.
Points TautString(const std::vector<Barrier>& barriers, const Eigen::Vector2d& from, const Eigen::Vector2d& to, bool over) {
  const double length = to.x();
  Points knots = {from};
  double highest = std::max(from.y(), to.y());
  for (size_t i = 1; i < barriers.size(); ++i) {
    const double top = std::max(barriers[i].z, barriers[i - 1].z), at = barriers[i].from_m;
    if (top == Heights::kNothing) continue;
    const double lifted = top + kLift_m * std::min({1.0, at / kLiftFullAfter_m, (length - at) / kLiftFullAfter_m});
    highest = std::max(highest, lifted);
    knots.emplace_back(at, lifted);
  }
  if (over) {
    knots.emplace_back(kRisenAt * length, highest);
    knots.emplace_back((1.0 - kRisenAt) * length, highest);
    std::stable_sort(knots.begin(), knots.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  }
  knots.push_back(to);
  Points hull;
  for (const Eigen::Vector2d& knot : knots) {
    while (hull.size() >= 2) {
      const Eigen::Vector2d &a = hull[hull.size() - 2], &b = hull.back();
      if ((b.y() - a.y()) * (knot.x() - a.x()) > (knot.y() - a.y()) * (b.x() - a.x())) break;
      hull.pop_back();
    }
    hull.push_back(knot);
  }
  return hull;
}

// Quadratic Bezier curve; the length never falls along it, as it does not along its control points.
Eigen::Vector2d OnCurve(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, double u) {
  return (1.0 - u) * (1.0 - u) * a + 2.0 * u * (1.0 - u) * b + u * u * c;
}

Points RoundedCorner(const Eigen::Vector2d& before, const Eigen::Vector2d& corner, const Eigen::Vector2d& after, const IsClear& is_clear) {
  const Eigen::Vector2d into = corner - before, out = after - corner;
  const double angle = std::abs(std::atan2(into.x() * out.y() - into.y() * out.x(), into.dot(out)));
  if (angle < kLeastCorner_rad) return {corner};
  const int parts = std::max(4, static_cast<int>(std::ceil(angle / kRoundStep_rad)));
  double radius = std::min(into.norm(), out.norm()) / 2.0;
  for (int attempt = 0; attempt < kRoundings && radius >= kLeastRounding_m; ++attempt, radius /= 2.0) {
    const Eigen::Vector2d a = corner - into / into.norm() * radius, b = corner + out / out.norm() * radius;
    Points curve;
    bool clear = true;
    for (int k = 0; k <= parts && clear; ++k) {
      curve.push_back(OnCurve(a, corner, b, static_cast<double>(k) / parts));
      clear = k == 0 || is_clear(curve[curve.size() - 2], curve.back());
    }
    if (clear) return curve;
  }
  return {corner};
}

// Each corner becomes as wide a curve as is clear, at most to the middles of its edges.
Points Rounded(const Points& points, const IsClear& is_clear) {
  Points result;
  for (size_t i = 0; i < points.size(); ++i) {
    const bool inner = i > 0 && i + 1 < points.size();
    const Points some = inner ? RoundedCorner(points[i - 1], points[i], points[i + 1], is_clear) : Points{points[i]};
    for (const Eigen::Vector2d& point : some) {
      // Two curves can meet in the middle of an edge.
      if (result.empty() || point != result.back()) result.push_back(point);
    }
  }
  return result;
}

}  // namespace

Points ProfileAlong(const PlanLine& line, double from_z, double to_z, const Heights* heights, bool over) {
  const double length = line.Length();
  const Eigen::Vector2d begin(0.0, from_z), end(length, to_z);
  if (!(length > 0.0)) return {begin, end};
  if (!over && (heights == nullptr || KeepsClear(line, *heights, begin, end))) return {begin, end};
  const auto base_z = [&](double at) { return from_z + (to_z - from_z) * at / length; };
  const std::vector<Barrier> barriers = heights == nullptr ? std::vector<Barrier>() : BarriersAlong(line, *heights, base_z);
  const Barrier* first = barriers.empty() ? nullptr : &barriers.front();
  const Barrier* last = barriers.empty() ? nullptr : &barriers.back();
  Points whole = TautString(barriers, {0.0, LiftedOver(from_z, first)}, {length, LiftedOver(to_z, last)}, over);
  // An end that is too near itself is left straight up and reached straight down.
  if (whole.front().y() != from_z) whole.insert(whole.begin(), begin);
  if (whole.back().y() != to_z) whole.push_back(end);
  return Rounded(whole, [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return heights == nullptr || KeepsClear(line, *heights, a, b); });
}

}  // namespace skyquilt::tour
