#include "simulate/roof_overhangs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <string>

#include "simulate/outline.h"

namespace skyquilt::simulate {
namespace {

CityLayout Layout(int seed, const std::string& shapes, int* tree_detail = nullptr) {
  SimulateOptions options;
  options.place = "town";
  options.seed = seed;
  options.building_shapes = shapes;
  const PlaceSpec place = ResolvePlace(options);
  if (tree_detail != nullptr) *tree_detail = place.city.tree_detail;
  const Eigen::Vector2d surround = Eigen::Vector2d::Constant(place.surround_m);
  return {place.city, place.area_min - surround, place.area_max + surround, place.seed};
}

bool IsSmall(const Building& b) {
  return b.kind == BuildingKind::kShed || b.kind == BuildingKind::kGarage;
}

// As large as its roof.
Building UnderRoof(Building b) {
  b.length_m += 2.0 * b.RoofOverhang();
  b.width_m += 2.0 * b.RoofOverhang();
  return b;
}

TEST(RoofOverhangs, DifferBetweenOutlinesAndNotWithin) {
  for (int seed = 1; seed <= 6; ++seed) {
    const CityLayout layout = Layout(seed, "varied");
    const std::vector<Building>& buildings = layout.contents().buildings;
    double smallest = 9.0, largest = 0.0;
    std::set<double> different;
    size_t n_pitched = 0;
    for (const Outline& outline : FindOutlines(buildings)) {
      const Building& main = buildings[outline.first];
      for (size_t i = outline.first; i < outline.first + outline.n_parts; ++i) EXPECT_EQ(buildings[i].overhang_m, main.overhang_m);
      if (main.roof == RoofKind::kFlat) {
        EXPECT_EQ(main.RoofOverhang(), 0.0);
        continue;
      }
      EXPECT_EQ(main.RoofOverhang(), main.overhang_m);
      EXPECT_GT(main.overhang_m, 0.05);
      EXPECT_LE(main.overhang_m, IsSmall(main) ? kLargestShedOverhang_m : kLargestOverhang_m);
      ++n_pitched;
      different.insert(main.overhang_m);
      if (IsSmall(main)) continue;
      smallest = std::min(smallest, main.overhang_m);
      largest = std::max(largest, main.overhang_m);
    }
    EXPECT_EQ(different.size(), n_pitched) << seed;
    EXPECT_LT(smallest, 0.3) << seed;
    EXPECT_GT(largest, 0.65) << seed;
  }
}

TEST(RoofOverhangs, AreAllTheSameInPlainTowns) {
  const CityLayout layout = Layout(2, "plain");
  for (const Building& b : layout.contents().buildings) EXPECT_EQ(b.overhang_m, kRoofOverhang_m);
}

TEST(RoofOverhangs, LeaveRoomBetweenOutlines) {
  for (int seed = 1; seed <= 6; ++seed) {
    const CityLayout layout = Layout(seed, "varied");
    const std::vector<Building>& buildings = layout.contents().buildings;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Building& a : buildings) {
      for (const Building& b : buildings) {
        if (a.outline < b.outline && (a.centre - b.centre).cwiseAbs().maxCoeff() < 60.0)
          nearest = std::min(nearest, Clearance(UnderRoof(a), UnderRoof(b)));
      }
    }
    EXPECT_GT(nearest, 0.15) << seed;
  }
}

// Only roofs may depend on it.
TEST(RoofOverhangs, ChangeNoWall) {
  const CityLayout layout = Layout(1, "varied");
  for (const Building& b : layout.contents().buildings) {
    Building wide = b, narrow = b;
    wide.overhang_m = 0.8;
    narrow.overhang_m = 0.1;
    Mesh of_wide, of_narrow;
    AddBuilding(wide, 0, of_wide);
    AddBuilding(narrow, 0, of_narrow);
    ASSERT_EQ(of_wide.triangle.size(), of_narrow.triangle.size());
    for (size_t i = 0; i < of_wide.triangle.size(); ++i) {
      ASSERT_EQ(of_wide.tag[i].part, of_narrow.tag[i].part);
      if (of_wide.tag[i].part == Part::kPitchedRoof) continue;
      for (size_t k = 0; k < 3; ++k) EXPECT_EQ(of_wide.position[of_wide.triangle[i][k]], of_narrow.position[of_narrow.triangle[i][k]]);
    }
  }
}

// The roof's triangles end where the building says, and stay in the planes of the roof.
TEST(RoofOverhangs, AreWhereTheRoofEnds) {
  const CityLayout layout = Layout(3, "varied");
  int n_checked = 0;
  for (const Building& b : layout.contents().buildings) {
    if (b.roof == RoofKind::kFlat || b.onto_rise > 0.0) continue;
    Mesh mesh;
    AddBuilding(b, 0, mesh);
    std::array<double, 4> reach{};  // beyond the walls at +x, +y, -x, -y
    double lowest = 1e9;
    for (size_t i = 0; i < mesh.triangle.size(); ++i) {
      if (mesh.tag[i].part != Part::kPitchedRoof) continue;
      for (const uint32_t vertex : mesh.triangle[i]) {
        const Eigen::Vector3d local = b.Local(mesh.position[vertex]).cast<double>();
        reach = {std::max(reach[0], local.x() - 0.5 * b.length_m), std::max(reach[1], local.y() - 0.5 * b.width_m),
                 std::max(reach[2], -local.x() - 0.5 * b.length_m), std::max(reach[3], -local.y() - 0.5 * b.width_m)};
        lowest = std::min(lowest, local.z());
        const Eigen::Vector3d at = mesh.position[vertex].cast<double>();
        EXPECT_NEAR(at.z(), RoofHeight(b, at.head<2>()), 2e-4);
      }
    }
    for (size_t side = 0; side < 4; ++side) EXPECT_NEAR(reach[side], b.shared[side] ? 0.0 : b.overhang_m, 2e-4);
    EXPECT_NEAR(lowest, b.RoofEdgeHeight(), 2e-4);
    ++n_checked;
  }
  EXPECT_GT(n_checked, 20);
}

TEST(RoofOverhangs, AreNotTouchedByTrees) {
  for (const int seed : {1, 4}) {
    int tree_detail = 0;
    const CityLayout layout = Layout(seed, "varied", &tree_detail);
    for (const Tree& tree : layout.contents().trees) {
      Mesh crown;
      for (const Building& b : layout.contents().buildings) {
        if (b.roof == RoofKind::kFlat || b.DistanceTo(tree.position) > 8.0) continue;
        if (crown.position.empty()) AddTree(tree, 0, tree_detail, crown);
        double highest = -1.0;
        for (const Eigen::Vector3f& vertex : crown.position) {
          if (b.DistanceTo(vertex.head<2>().cast<double>()) < b.RoofOverhang()) highest = std::max(highest, static_cast<double>(vertex.z()));
        }
        EXPECT_LT(highest, b.RoofEdgeHeight()) << seed << " at " << tree.position.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace skyquilt::simulate
