#include <algorithm>
#include <cmath>
#include <numbers>

#include "buildings/shape/axis_points.h"
#include "buildings/shape/find_shape.h"
#include "buildings/shape/right_angle.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastFall = 0.12;         // horizontal part of a plane's normal, 7 degrees: flatter ones fall by chance
constexpr double kPlaneSigma = 0.12;        // of the tilt of a plane of 1 m2, radians; falls with the root of the area
constexpr double kLeastPlaneSigma = 0.012;  // of a large one: surfaces are bent
constexpr double kWallSigma_rad = 0.3;      // of the normal of a steep point
constexpr double kWallPiece_m2 = 1.0;       // of wall whose points err alike
constexpr double kSimple_m = 0.5;           // outlines follow raster cells: their own edges say nothing
constexpr double kShortestEdge_m = 2.5;
constexpr double kEdgeSigma_m = 0.25;  // of a straight edge's ends, together
constexpr double kNear_rad = 10.0 * std::numbers::pi / 180.0;
constexpr double kLeastSigma_rad = 0.002;

// One observation of the direction, modulo 90 degrees.
struct DirectionEvidence {
  double angle_rad = 0.0;
  double sigma_rad = 1.0;
  double count = 1.0;  // independent observations that it stands for

  double Weight() const { return count / (sigma_rad * sigma_rad); }
};

void AddPlanes(const Candidate& candidate, std::vector<DirectionEvidence>* evidence) {
  for (const RoofPlane& plane : candidate.planes) {
    const double fall = plane.normal.head<2>().norm();
    if (!(fall > kLeastFall) || std::abs(plane.normal.z()) < kWallNormal || !(plane.area_m2 > 0.0)) continue;
    const double tilt = std::max(kLeastPlaneSigma, kPlaneSigma / std::sqrt(plane.area_m2));
    evidence->push_back({std::atan2(plane.normal.y(), plane.normal.x()), tilt / fall, 1.0});
  }
}

void AddWalls(const Candidate& candidate, const PointCloud& cloud, std::vector<DirectionEvidence>* evidence) {
  const double count = std::min(1.0, cloud.spacing_m * cloud.spacing_m / kWallPiece_m2);
  const auto add = [&](const std::vector<uint32_t>& points) {
    for (const uint32_t i : points) {
      const Eigen::Vector3f& normal = cloud.points[i].normal;
      if (!normal.allFinite() || std::abs(static_cast<double>(normal.z())) >= kWallNormal) continue;
      evidence->push_back({std::atan2(static_cast<double>(normal.y()), static_cast<double>(normal.x())), kWallSigma_rad, count});
    }
  };
  add(candidate.wall);
}

// The direction of a stretch of a ring by the moments of its edges about their middle, each edge as a straight piece.
double DirectionOf(const std::vector<Eigen::Vector2d>& ring, size_t first, size_t last, double trimmed_m) {
  const Eigen::Vector2d &a = ring[first], &b = ring[last % ring.size()];
  const Eigen::Vector2d along = (b - a).normalized();
  const double length = (b - a).norm(), from = trimmed_m, to = length - trimmed_m;
  double weight = 0.0, t_sum = 0.0, d_sum = 0.0, tt_sum = 0.0, td_sum = 0.0;
  for (size_t i = first; i < last; ++i) {
    const Eigen::Vector2d &p = ring[i % ring.size()], &q = ring[(i + 1) % ring.size()];
    const int pieces = std::max(1, static_cast<int>((q - p).norm() / 0.1));
    for (int k = 0; k < pieces; ++k) {
      const Eigen::Vector2d x = p + (k + 0.5) / pieces * (q - p) - a;
      const double t = along.dot(x), d = along.x() * x.y() - along.y() * x.x();
      // Corners that the simpler outline cuts would turn the line.
      if (t < from || t > to) continue;
      const double w = std::abs(along.dot(q - p)) / pieces + 1e-9;
      weight += w;
      t_sum += w * t;
      d_sum += w * d;
      tt_sum += w * t * t;
      td_sum += w * t * d;
    }
  }
  const double base = std::atan2(along.y(), along.x());
  const double spread = weight > 0.0 ? tt_sum - t_sum * t_sum / weight : 0.0;
  return spread > 1e-9 ? base + std::atan((td_sum - t_sum * d_sum / weight) / spread) : base;
}

// Straight edges of the outline: where its simpler version has long ones.
void AddEdges(const Candidate& candidate, std::vector<DirectionEvidence>* evidence) {
  if (candidate.outline.outer.size() < 3) return;
  const Polygon simple = Simplified(candidate.outline, kSimple_m);
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring, const std::vector<Eigen::Vector2d>& full) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &a = ring[i], &b = ring[(i + 1) % ring.size()];
      const double length = (b - a).norm();
      if (length < kShortestEdge_m) continue;
      double angle = std::atan2(b.y() - a.y(), b.x() - a.x());
      const auto first = std::find(full.begin(), full.end(), a), last = std::find(full.begin(), full.end(), b);
      if (first != full.end() && last != full.end()) {
        const auto from = static_cast<size_t>(first - full.begin());
        auto to = static_cast<size_t>(last - full.begin());
        if (to <= from) to += full.size();
        angle = DirectionOf(full, from, to, std::min(0.75, 0.15 * length));
      }
      evidence->push_back({angle, kEdgeSigma_m / length, 1.0});
    }
  };
  add(simple.outer, candidate.outline.outer);
  for (size_t i = 0; i < simple.holes.size() && simple.holes.size() == candidate.outline.holes.size(); ++i) {
    add(simple.holes[i], candidate.outline.holes[i]);
  }
}

// The direction with most evidence within 10 degrees, in steps of one degree.
double Densest(const std::vector<DirectionEvidence>& evidence) {
  double best = 0.0, most = -1.0;
  for (int degree = 0; degree < 90; ++degree) {
    const double at = degree * std::numbers::pi / 180.0;
    double sum = 0.0;
    for (const DirectionEvidence& one : evidence) {
      const double d = RightAngleDifference(one.angle_rad, at) / kNear_rad;
      if (std::abs(d) < 1.0) sum += one.Weight() * (1.0 - d * d) * (1.0 - d * d);
    }
    if (sum > most) {
      most = sum;
      best = at;
    }
  }
  return best;
}

// Of the mean of the evidence near it, enlarged where that scatters more than its own sigmas say. For evidence of one kind this is the formula of
// structure.md: spread over the root of the number of observations.
double SigmaOf(const std::vector<DirectionEvidence>& evidence, double yaw) {
  double precision = 0.0, count = 0.0, squares = 0.0;
  for (const DirectionEvidence& one : evidence) {
    const double difference = RightAngleDifference(one.angle_rad, yaw);
    // All of it counts that its own sigma lets scatter, or the wide tails of wall normals would be cut.
    if (std::abs(difference) >= std::max(kNear_rad, 3.0 * one.sigma_rad)) continue;
    precision += one.Weight();
    count += one.count;
    squares += one.Weight() * difference * difference;
  }
  if (!(precision > 0.0)) return 1.0;
  const double excess = std::max(1.0, squares / count);
  return std::clamp(std::sqrt(excess / precision), kLeastSigma_rad, 1.0);
}

}  // namespace

Direction FindDirection(const Candidate& candidate, const PointCloud& cloud) {
  std::vector<DirectionEvidence> evidence;
  AddPlanes(candidate, &evidence);
  AddWalls(candidate, cloud, &evidence);
  AddEdges(candidate, &evidence);
  if (evidence.empty()) return {};

  // How far all of the evidence agrees.
  double weight = 0.0, cosine = 0.0, sine = 0.0;
  for (const DirectionEvidence& one : evidence) {
    const double w = one.Weight();
    weight += w;
    cosine += w * std::cos(4.0 * one.angle_rad);
    sine += w * std::sin(4.0 * one.angle_rad);
  }
  Direction result;
  result.concentration = std::min(1.0, std::hypot(cosine, sine) / weight);
  double yaw = Densest(evidence);
  for (int step = 0; step < 20; ++step) {
    double sum = 0.0, turn = 0.0;
    for (const DirectionEvidence& one : evidence) {
      const double difference = RightAngleDifference(one.angle_rad, yaw), d = difference / kNear_rad;
      if (std::abs(d) >= 1.0) continue;
      const double w = one.Weight() * (1.0 - d * d) * (1.0 - d * d);
      sum += w;
      turn += w * difference;
    }
    if (!(sum > 0.0)) break;
    yaw += turn / sum;
    if (std::abs(turn / sum) < 1e-7) break;
  }
  result.yaw_rad = InRightAngle(yaw);
  result.sigma_rad = SigmaOf(evidence, yaw);
  return result;
}

}  // namespace skyquilt::buildings
