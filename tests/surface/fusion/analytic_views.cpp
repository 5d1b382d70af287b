#include "tests/surface/fusion/analytic_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

namespace skyquilt::surface::test {
namespace {

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

void Keep(double t, const Eigen::Vector3d& normal, Hit* hit) {
  if (t > 1e-6 && t < hit->t) *hit = {t, normal};
}

Hit FirstHit(const AnalyticScene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  Hit hit;
  for (const Plane& plane : scene.planes) {
    Keep((plane.point - origin).dot(plane.normal) / direction.dot(plane.normal), plane.normal, &hit);
  }
  for (const Sphere& sphere : scene.spheres) {
    const Eigen::Vector3d to = origin - sphere.centre;
    const double b = to.dot(direction);
    const double root = b * b - to.squaredNorm() + sphere.radius * sphere.radius;
    if (root > 0.0) Keep(-b - std::sqrt(root), to + (-b - std::sqrt(root)) * direction, &hit);
  }
  for (const Box& box : scene.boxes) {
    double enter = -std::numeric_limits<double>::infinity(), leave = -enter;
    int entered = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double a = (box.min[axis] - origin[axis]) / direction[axis];
      const double b = (box.max[axis] - origin[axis]) / direction[axis];
      if (std::min(a, b) > enter) {
        enter = std::min(a, b);
        entered = axis;
      }
      leave = std::min(leave, std::max(a, b));
    }
    if (enter < leave) Keep(enter, Eigen::Vector3d::Unit(entered), &hit);
  }
  return hit;
}

double DistanceToBox(const Box& box, const Eigen::Vector3d& x) {
  const Eigen::Vector3d outside = (box.min - x).cwiseMax(x - box.max);
  return outside.maxCoeff() > 0.0 ? outside.cwiseMax(0.0).norm() : -outside.maxCoeff();
}

}  // namespace

double AnalyticScene::Distance(const Eigen::Vector3d& x) const {
  double distance = std::numeric_limits<double>::infinity();
  for (const Plane& plane : planes) distance = std::min(distance, std::abs((x - plane.point).dot(plane.normal.normalized())));
  for (const Sphere& sphere : spheres) distance = std::min(distance, std::abs((x - sphere.centre).norm() - sphere.radius));
  for (const Box& box : boxes) distance = std::min(distance, DistanceToBox(box, x));
  return distance;
}

void Pictures::Add(const AnalyticScene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& target, double focal_px, int size_px, int photo) {
  ViewPose pose;
  pose.photo = photo;
  pose.width = pose.height = size_px;
  pose.focal_px = focal_px;
  pose.cx = 0.5 * size_px + 0.3;
  pose.cy = 0.5 * size_px - 0.2;
  const Eigen::Vector3d forward = (target - from).normalized();
  const Eigen::Vector3d any = std::abs(forward.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  const Eigen::Vector3d right = forward.cross(any).normalized();
  Eigen::Matrix3d rotation;
  rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  pose.cam_from_enu.rotation = Eigen::Quaterniond(rotation);
  pose.cam_from_enu.translation = -(pose.cam_from_enu.rotation * from);
  const auto n_pixels = static_cast<size_t>(size_px) * static_cast<size_t>(size_px);
  std::vector<float> depths(n_pixels, std::numeric_limits<float>::quiet_NaN());
  std::vector<uint8_t> cosines(n_pixels, 0);
  for (size_t i = 0; i < n_pixels; ++i) {
    const Eigen::Vector3d direction =
        pose.DirectionAt(static_cast<double>(i % static_cast<size_t>(size_px)) + 0.5, static_cast<double>(i / static_cast<size_t>(size_px)) + 0.5);
    const Hit hit = FirstHit(scene, from, direction);
    if (!std::isfinite(hit.t)) continue;
    const double c = std::abs(hit.normal.normalized().dot(direction));
    // Like the renderer: nothing at flatter angles than 80 degrees.
    if (c < 0.1736) continue;
    depths[i] = static_cast<float>(hit.t);
    cosines[i] = static_cast<uint8_t>(std::lround(255.0 * c));
  }
  depth_m.push_back(std::move(depths));
  cosine.push_back(std::move(cosines));
  views.push_back({pose, depth_m.back(), cosine.back()});
}

std::vector<Eigen::Vector3d> EvenDirections(int n, bool upper_half) {
  std::vector<Eigen::Vector3d> directions;
  for (int i = 0; i < n; ++i) {
    const double share = (i + 0.5) / n;
    const double z = upper_half ? 0.25 + 0.75 * share : 2.0 * share - 1.0;
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

MeshCheck CheckMesh(const Mesh& mesh) {
  MeshCheck check;
  std::map<std::pair<uint32_t, uint32_t>, int> directed;
  // Around each vertex, every triangle leads from one neighbour to the next.
  std::vector<std::map<uint32_t, uint32_t>> next(mesh.position.size());
  for (const Triangle& t : mesh.triangle) {
    for (size_t i = 0; i < 3; ++i) {
      ++directed[{t[i], t[(i + 1) % 3]}];
      next[t[i]][t[(i + 1) % 3]] = t[(i + 2) % 3];
    }
    const Eigen::Vector3d a = mesh.position[t[0]], b = mesh.position[t[1]], c = mesh.position[t[2]];
    check.degenerate += (b - a).cross(c - a).norm() > 0.0 ? 0 : 1;
  }
  for (const auto& [edge, count] : directed) {
    if (count > 1) ++check.bad_edges;
    if (!directed.contains({edge.second, edge.first})) ++check.boundary_edges;
  }
  for (uint32_t v = 0; v < next.size(); ++v) {
    const std::map<uint32_t, uint32_t>& fan = next[v];
    if (fan.empty()) continue;
    // An open fan begins where no triangle leads to.
    std::set<uint32_t> reached;
    for (const auto& [from, to] : fan) reached.insert(to);
    uint32_t start = fan.begin()->first;
    for (const auto& [from, to] : fan) {
      if (!reached.contains(from)) start = from;
    }
    size_t n = 0;
    uint32_t at = start;
    while (n <= fan.size() && fan.contains(at)) {
      at = fan.at(at);
      ++n;
      if (at == start) break;
    }
    if (n != fan.size()) check.bad_vertices.push_back(v);
  }
  return check;
}

std::set<std::array<uint64_t, 3>> KeyTriangles(const Mesh& mesh) {
  std::set<std::array<uint64_t, 3>> triangles;
  for (const Triangle& t : mesh.triangle) {
    std::array<uint64_t, 3> keys{mesh.key[t[0]], mesh.key[t[1]], mesh.key[t[2]]};
    std::rotate(keys.begin(), std::min_element(keys.begin(), keys.end()), keys.end());
    triangles.insert(keys);
  }
  return triangles;
}

double SignedVolume(const Mesh& mesh) {
  double volume = 0.0;
  for (const Triangle& t : mesh.triangle) volume += mesh.position[t[0]].dot(mesh.position[t[1]].cross(mesh.position[t[2]])) / 6.0;
  return volume;
}

}  // namespace skyquilt::surface::test
