#include "simulate/roof_overhangs.h"

#include <algorithm>

#include "core/base/random.h"

namespace skyquilt::simulate {
namespace {

constexpr double kFar_m = 2.0;          // outlines farther apart do not limit each other
constexpr double kCrownToRoof_m = 0.1;  // between crowns and overhangs
constexpr double kUnderEdge_m = 1.0;    // trees that are this much lower than a roof's edge stay under it on rolling ground too

// The largest overhang for which the part keeps clear of all other outlines, if these use their half of the room too.
double RoomFor(const Building& part, const std::vector<Building>& buildings) {
  double room_m = kLargestOverhang_m;
  for (const Building& other : buildings) {
    if (other.outline == part.outline) continue;
    const double reach_m = 0.5 * (part.length_m + part.width_m + other.length_m + other.width_m) + kFar_m;
    if ((other.centre - part.centre).cwiseAbs().maxCoeff() > reach_m) continue;
    const double gap_m = Clearance(part, other) - kBetweenRoofs_m;
    room_m = std::min(room_m, other.roof == RoofKind::kFlat ? gap_m : 0.5 * gap_m);
  }
  return std::max(room_m, 0.0);
}

bool TouchesRoof(const Tree& tree, const Mesh& crown, const Building& building) {
  if (tree.height_m < building.RoofEdgeHeight() - kUnderEdge_m) return false;
  const double reach_m = building.RoofOverhang() + kCrownToRoof_m;
  return std::any_of(crown.position.begin(), crown.position.end(),
                     [&](const Eigen::Vector3f& vertex) { return building.DistanceTo(vertex.head<2>().cast<double>()) < reach_m; });
}

}  // namespace

void DrawOverhangs(std::vector<Building>& buildings) {
  for (size_t first = 0; first < buildings.size();) {
    size_t end = first;
    double room_m = kLargestOverhang_m;
    for (; end < buildings.size() && buildings[end].outline == buildings[first].outline; ++end) {
      if (buildings[end].roof != RoofKind::kFlat) room_m = std::min(room_m, RoomFor(buildings[end], buildings));
    }
    const Building& main = buildings[first];
    const bool small = main.kind == BuildingKind::kShed || main.kind == BuildingKind::kGarage;
    const double largest_m = std::min(room_m, small ? kLargestShedOverhang_m : kLargestOverhang_m);
    const double smallest_m = std::min(largest_m, small ? kSmallestShedOverhang_m : kSmallestOverhang_m);
    base::Random random(main.seed, 7);
    const double drawn_m = random.Uniform(smallest_m, largest_m);
    for (; first < end; ++first) buildings[first].overhang_m = drawn_m;
  }
}

void RemoveTreesAtRoofs(int detail, CityContents& contents) {
  std::erase_if(contents.trees, [&](const Tree& tree) {
    Mesh crown;
    return std::any_of(contents.buildings.begin(), contents.buildings.end(), [&](const Building& building) {
      if (building.roof == RoofKind::kFlat) return false;
      if (building.DistanceTo(tree.position) > kCrownReach * tree.crown_radius_m + building.overhang_m + kCrownToRoof_m) return false;
      if (crown.position.empty()) AddTree(tree, 0, detail, crown);
      return TouchesRoof(tree, crown, building);
    });
  });
}

}  // namespace skyquilt::simulate
