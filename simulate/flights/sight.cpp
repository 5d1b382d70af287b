#include "simulate/flights/sight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kEndOfSight_m = 1e6F;
constexpr size_t kFeelers = 2 * raytrace::kPacket;
constexpr double kTopReach = 1.1;  // crowns reach no higher than this many heights of their tree

// Spread evenly over the sphere.
std::array<Vector3f, kFeelers> Feelers() {
  std::array<Vector3f, kFeelers> feelers;
  for (size_t i = 0; i < kFeelers; ++i) {
    const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(kFeelers);
    const double angle = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double level = std::sqrt(1.0 - z * z);
    feelers[i] = Vector3d(level * std::cos(angle), level * std::sin(angle), z).cast<float>();
  }
  return feelers;
}

bool IsInOrAtBuilding(const World& world, const Vector3d& at, double clearance_m) {
  const std::vector<Building>& buildings = world.buildings();
  return std::any_of(buildings.begin(), buildings.end(), [&](const Building& b) {
    return at.z() < b.ground_z_m + b.ridge_height_m + clearance_m && b.DistanceTo(at.head<2>()) < clearance_m;
  });
}

bool IsInOrAtTree(const World& world, const Vector3d& at, double clearance_m) {
  if (world.city() == nullptr) return false;
  const std::vector<Tree>& trees = world.city()->contents().trees;
  return std::any_of(trees.begin(), trees.end(), [&](const Tree& tree) {
    return at.z() < tree.ground_z_m + kTopReach * tree.height_m + clearance_m &&
           (tree.position - at.head<2>()).norm() < kCrownReach * tree.crown_radius_m + clearance_m;
  });
}

}  // namespace

std::optional<Sighting> LookAlong(const World& world, const Vector3d& from, const Vector3d& direction) {
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, from.cast<float>(), direction.cast<float>(), 0.0F, kEndOfSight_m);
  world.scene().Intersect(ray);
  if (ray.triangle[0] == raytrace::kNoTriangle) return std::nullopt;
  return Sighting{static_cast<double>(ray.t_far[0]), world.mesh().tag[ray.triangle[0]]};
}

bool SeesBuilding(const World& world, const Vector3d& from, const Vector3d& at, const Outline& building) {
  const std::optional<Sighting> seen = LookAlong(world, from, (at - from).normalized());
  if (!seen) return false;
  const bool is_part = seen->tag.part == Part::kWall || seen->tag.part == Part::kFlatRoof || seen->tag.part == Part::kPitchedRoof ||
                       seen->tag.part == Part::kParapet || seen->tag.part == Part::kRooftopBox || seen->tag.part == Part::kChimney;
  return is_part && seen->tag.object >= building.first && seen->tag.object < building.first + building.n_parts;
}

bool IsFree(const World& world, const Vector3d& at, double clearance_m) {
  if (IsInOrAtBuilding(world, at, clearance_m) || IsInOrAtTree(world, at, clearance_m)) return false;
  static const std::array<Vector3f, kFeelers> feelers = Feelers();
  const Mesh& mesh = world.mesh();
  raytrace::RayPacket rays;
  for (size_t begin = 0; begin < kFeelers; begin += raytrace::kPacket) {
    for (size_t lane = 0; lane < raytrace::kPacket; ++lane) rays.Set(lane, at.cast<float>(), feelers[begin + lane], 0.0F, kEndOfSight_m);
    world.scene().Intersect(rays);
    for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
      const uint32_t hit = rays.triangle[lane];
      if (hit == raytrace::kNoTriangle) continue;
      if (static_cast<double>(rays.t_far[lane]) < clearance_m) return false;
      // The back of a surface is seen from inside only, except that of roofs over the walls.
      if (mesh.tag[hit].part != Part::kPitchedRoof && mesh.FaceNormal(hit).dot(feelers[begin + lane]) > 0.0F) return false;
    }
  }
  return true;
}

}  // namespace skyquilt::simulate
