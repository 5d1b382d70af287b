#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/linear/linear.h"
#include "surface/mesh/border_loops.h"
#include "surface/mesh/hole_closing.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

constexpr size_t kMostHoleEdges = 2000;
constexpr double kLevelShare = 0.5, kLevelMargin_m = 0.5;
constexpr double kUpwards = 0.5, kUpwardsShare = 0.7;
constexpr double kDeepBelow_m = 3.0;
constexpr double kInPlane = 0.5, kInPlaneShare = 0.7;

// A hole in the ground if this border may be one, with an empty list of vertices if not.
Hole GroundHoleOf(const Mesh& mesh, const BorderLoop& loop, double max_area_m2) {
  const size_t n = loop.vertex.size();
  if (n < 3 || n > kMostHoleEdges) return {};
  Hole hole;
  Eigen::Vector3d low = mesh.position[loop.vertex[0]], high = low;
  const Eigen::Vector2d origin = low.head<2>();
  double double_area = 0.0, length = 0.0, upwards_length = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d &x = mesh.position[loop.vertex[i]], &y = mesh.position[loop.vertex[(i + 1) % n]];
    if (!x.allFinite()) return {};
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    double_area -= DoubleAreaFromAbove(origin, x.head<2>(), y.head<2>());  // the border runs clockwise around a hole
    const Triangle& t = mesh.triangle[loop.triangle[i]];
    const Eigen::Vector3d normal = DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    length += (y - x).norm();
    if (normal.z() > kUpwards * normal.norm()) upwards_length += (y - x).norm();
  }
  const double area = 0.5 * double_area;
  if (!(area > 0.0 && area <= max_area_m2) || upwards_length < kUpwardsShare * length) return {};
  if (high.z() - low.z() > kLevelShare * std::sqrt(area) + kLevelMargin_m) return {};
  hole.vertex.assign(loop.vertex.rbegin(), loop.vertex.rend());
  for (const uint32_t v : hole.vertex) hole.position.push_back(mesh.position[v]);
  if (CrossesItself(hole.position)) return {};
  hole.low = {low.x(), low.y(), low.z() - kDeepBelow_m};
  hole.high = {high.x(), high.y(), std::numeric_limits<double>::infinity()};
  return hole;
}

// The plane through the border, each vertex with the length of its edges as weight: a point and a normal of length 1. Nothing when the border is
// nearly a line.
struct BorderPlane {
  Eigen::Vector3d middle, normal;
};
std::optional<BorderPlane> PlaneOf(const std::vector<Eigen::Vector3d>& border) {
  const size_t n = border.size();
  const auto weight = [&](size_t i) { return (border[(i + 1) % n] - border[i]).norm() + (border[i] - border[(i + n - 1) % n]).norm(); };
  double sum = 0.0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < n; ++i) {
    sum += weight(i);
    middle += weight(i) * border[i];
  }
  middle /= sum;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < n; ++i) covariance += weight(i) / sum * (border[i] - middle) * (border[i] - middle).transpose();
  if (!covariance.allFinite()) return std::nullopt;
  const linear::EigenPairs<3> axes = linear::SymmetricEigen<3>(covariance);  // values rise
  if (!(axes.values[1] > 1e-6 * axes.values[2])) return std::nullopt;
  return BorderPlane{middle, axes.vectors.col(0)};
}

// A hole in a plane of any direction if this border may be one, with an empty list of vertices if not.
Hole PlanarHoleOf(const Mesh& mesh, const BorderLoop& loop, double max_area_m2, double off_plane_m) {
  const size_t n = loop.vertex.size();
  if (n < 3 || n > kMostHoleEdges) return {};
  Hole hole;
  hole.vertex.assign(loop.vertex.rbegin(), loop.vertex.rend());
  std::vector<Eigen::Vector3d> border;
  for (const uint32_t v : hole.vertex) border.push_back(mesh.position[v]);
  const std::optional<BorderPlane> plane = PlaneOf(border);
  if (!plane) return {};
  // The border runs clockwise around a hole, as seen from the free space.
  Eigen::Vector3d double_area = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < n; ++i) double_area += Cross(border[i] - plane->middle, border[(i + 1) % n] - plane->middle);
  const Eigen::Vector3d normal = double_area.dot(plane->normal) < 0.0 ? Eigen::Vector3d(-plane->normal) : plane->normal;
  const double area = 0.5 * double_area.dot(normal);
  if (!(area > 0.0 && area <= max_area_m2)) return {};
  double length = 0.0, in_plane_length = 0.0;
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d &x = mesh.position[loop.vertex[i]], &y = mesh.position[loop.vertex[(i + 1) % n]];
    if (!(std::abs((x - plane->middle).dot(normal)) <= off_plane_m)) return {};
    const Triangle& t = mesh.triangle[loop.triangle[i]];
    const Eigen::Vector3d beside = DoubleAreaNormal(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    length += (y - x).norm();
    if (beside.dot(normal) > kInPlane * beside.norm()) in_plane_length += (y - x).norm();
  }
  if (in_plane_length < kInPlaneShare * length) return {};
  Eigen::Matrix3d turn;
  turn.row(2) = normal;
  turn.row(0) = Cross(normal, std::abs(normal.x()) < 0.6 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY()).normalized();
  turn.row(1) = Cross(normal, turn.row(0));
  hole.turn = turn;
  hole.low = hole.high = border[0];
  for (const Eigen::Vector3d& x : border) {
    hole.position.push_back(hole.Turned(x));
    hole.low = hole.low.cwiseMin(x);
    hole.high = hole.high.cwiseMax(x);
  }
  if (CrossesItself(hole.position)) return {};
  // Further off the plane, other surfaces do no harm: whether something farther is seen through the hole is for the photos to tell.
  const double near_m = 2.0 * off_plane_m;
  hole.low.array() -= near_m;
  hole.high.array() += near_m;
  hole.lowest_m = hole.Turned(plane->middle).z() - near_m;
  hole.highest_m = hole.lowest_m + 2.0 * near_m;
  return hole;
}

}  // namespace

double FillGroundHoles(Mesh* mesh, double max_area_m2, double spacing_m) {
  if (!(max_area_m2 > 0.0)) return 0.0;
  const std::vector<EdgeUse> uses = SortedEdgeUses(*mesh);
  std::vector<Hole> holes;
  for (const BorderLoop& loop : SimpleBorderLoops(*mesh, uses)) {
    Hole hole = GroundHoleOf(*mesh, loop, max_area_m2);
    if (!hole.vertex.empty()) holes.push_back(std::move(hole));
  }
  return CloseHoles(std::move(holes), uses, spacing_m, nullptr, mesh);
}

double FillPlanarHoles(Mesh* mesh, double max_area_m2, double spacing_m, double off_plane_m, const IsOpenThere& is_open) {
  if (!(max_area_m2 > 0.0)) return 0.0;
  const std::vector<EdgeUse> uses = SortedEdgeUses(*mesh);
  std::vector<Hole> holes;
  for (const BorderLoop& loop : SimpleBorderLoops(*mesh, uses)) {
    if (!GroundHoleOf(*mesh, loop, max_area_m2).vertex.empty()) continue;
    Hole hole = PlanarHoleOf(*mesh, loop, max_area_m2, off_plane_m);
    if (!hole.vertex.empty()) holes.push_back(std::move(hole));
  }
  return CloseHoles(std::move(holes), uses, spacing_m, is_open, mesh);
}

}  // namespace skyquilt::surface
