#include "simulate/wall_trees.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr double kShare = 0.4;         // of the outlines at which a tree is tried
constexpr double kBelowEdge_m = 0.1;   // crowns under overhangs end this far below them
constexpr double kFromOthers_m = 0.3;  // between a crown and walls or roofs that it does not touch
constexpr double kLowestTree_m = 2.2;

struct FreeWall {
  Vector2d middle;
  Vector2d out;  // unit, away from the building
  double length_m = 0.0;
};

FreeWall WallOf(const Building& part, size_t side) {
  const Vector2d u = part.Axis(), v(-u.y(), u.x());
  FreeWall wall;
  wall.out = (side < 2 ? 1.0 : -1.0) * (side % 2 == 0 ? u : v);
  wall.middle = part.centre + 0.5 * (side % 2 == 0 ? part.length_m : part.width_m) * wall.out;
  wall.length_m = side % 2 == 0 ? part.width_m : part.length_m;
  return wall;
}

// How far a tree reaches from its trunk towards a direction in the plane.
double ReachOf(const Tree& tree, int detail, const Vector2d& direction) {
  Tree at_origin = tree;
  at_origin.position = Vector2d::Zero();
  Mesh mesh;
  AddTree(at_origin, 0, detail, mesh);
  double reach = 0.0;
  for (const Eigen::Vector3f& vertex : mesh.position) reach = std::max(reach, direction.dot(vertex.head<2>().cast<double>()));
  return reach;
}

bool MayHaveTree(const Building& part) {
  return part.kind == BuildingKind::kHouse || part.kind == BuildingKind::kShed || part.kind == BuildingKind::kGarage;
}

}  // namespace

void AddTreesAtWalls(int detail, const std::function<bool(const Vector2d&)>& is_free, CityContents& contents, base::Random& random) {
  for (size_t i = 0; i < contents.buildings.size(); ++i) {
    const Building& part = contents.buildings[i];
    const bool wanted = random.UniformDouble() < kShare;
    const auto side = static_cast<size_t>(random.Below(4));
    const double size = random.UniformDouble(), along = random.Uniform(-1.0, 1.0);
    Tree tree;
    tree.seed = random.NextU32();
    if (!wanted || !MayHaveTree(part) || part.joined || part.shared[side]) continue;
    // Beside a flat roof a crown may be higher than the wall, as nothing hangs over.
    const bool flat = part.roof == RoofKind::kFlat;
    const double highest = flat ? std::clamp(1.5 * part.eave_height_m, 4.0, 8.0) : part.RoofEdgeHeight() - kBelowEdge_m;
    tree.height_m = (0.75 + 0.25 * size) * highest;
    if (tree.height_m < kLowestTree_m) continue;
    tree.crown_radius_m = 0.3 * tree.height_m;
    const FreeWall wall = WallOf(part, side);
    const Vector2d across(-wall.out.y(), wall.out.x());
    const double play = std::max(0.5 * wall.length_m - kCrownReach * tree.crown_radius_m, 0.0);
    tree.position = wall.middle + (ReachOf(tree, detail, -wall.out) + kTouch_m) * wall.out + along * play * across;
    if (!is_free(tree.position)) continue;
    const double to_others = kCrownReach * tree.crown_radius_m + kFromOthers_m;
    const bool clear = std::all_of(contents.buildings.begin(), contents.buildings.end(), [&](const Building& other) {
      return &other == &part || other.DistanceTo(tree.position) > to_others + other.RoofOverhang();
    });
    const bool apart = std::all_of(contents.trees.begin(), contents.trees.end(), [&](const Tree& other) {
      return (other.position - tree.position).norm() > 0.8 * (other.crown_radius_m + tree.crown_radius_m);
    });
    const bool parked_over =
        std::any_of(contents.parked.begin(), contents.parked.end(), [&](const Car& car) { return (car.position - tree.position).norm() < 2.5; });
    if (clear && apart && !parked_over) contents.trees.push_back(tree);
  }
}

}  // namespace skyquilt::simulate
