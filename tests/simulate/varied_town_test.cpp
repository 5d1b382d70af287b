// Towns with buildings of many shapes: what stands where.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "simulate/city_layout.h"
#include "simulate/outline.h"
#include "tests/simulate/is_inside.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

PlaceSpec Varied(const std::string& name, int seed, double tower_m = 0.0) {
  SimulateOptions options;
  options.place = name;
  options.seed = seed;
  options.building_shapes = "varied";
  options.tower_m = tower_m;
  return ResolvePlace(options);
}

CityLayout VariedLayout(const PlaceSpec& place) {
  const Vector2d surround = Vector2d::Constant(place.surround_m);
  return {place.city, place.area_min - surround, place.area_max + surround, place.seed};
}

std::string VariedName(const PlaceSpec& place) {
  return place.name + " " + std::to_string(place.seed);
}

struct Place {
  PlaceSpec spec;
  CityLayout layout;
};

// Made once, as a small city takes a while.
const std::vector<Place>& VariedPlaces() {
  static const std::vector<Place> places = [] {
    std::vector<PlaceSpec> specs;
    for (int seed = 1; seed <= 8; ++seed) specs.push_back(Varied("town", seed, seed % 3 == 0 ? 60.0 : 0.0));
    for (int seed = 1; seed <= 4; ++seed) specs.push_back(Varied("hamlet", seed));
    specs.push_back(Varied("smallcity", 2));
    std::vector<Place> made;
    for (const PlaceSpec& spec : specs) made.push_back({spec, VariedLayout(spec)});
    return made;
  }();
  return places;
}

std::vector<Vector2d> CornersOf(const Building& b) {
  const Vector2d u = 0.5 * b.length_m * b.Axis(), v = 0.5 * b.width_m * Vector2d(-b.Axis().y(), b.Axis().x());
  return {b.centre + u + v, b.centre - u + v, b.centre - u - v, b.centre + u - v};
}

TEST(VariedTown, EveryShapeAndKindOccurs) {
  for (int seed = 1; seed <= 40; ++seed) {
    const CityLayout layout = VariedLayout(Varied("town", seed));
    std::map<BuildingShape, int> shapes;
    std::map<BuildingKind, int> kinds;
    std::map<RoofKind, int> roofs;
    int n_large_sheds = 0, n_boxes = 0;
    const std::vector<Building>& buildings = layout.contents().buildings;
    const std::vector<Outline> outlines = FindOutlines(buildings);
    for (const Outline& outline : outlines) {
      const Building& main = buildings[outline.first];
      ++shapes[main.shape];
      ++kinds[main.kind];
      ++roofs[main.roof];
      if (main.kind == BuildingKind::kShed && outline.area_m2 >= 10.0 && outline.area_m2 <= 16.0) ++n_large_sheds;
      if (main.kind == BuildingKind::kGarage) {
        EXPECT_EQ(main.roof, RoofKind::kFlat);
        EXPECT_EQ(outline.n_parts, 1U);
      }
      n_boxes += main.roof == RoofKind::kFlat && !main.bare_roof && main.kind != BuildingKind::kShed && main.kind != BuildingKind::kGarage ? 1 : 0;
    }
    for (const BuildingShape shape :
         {BuildingShape::kRectangle, BuildingShape::kL, BuildingShape::kT, BuildingShape::kSetback, BuildingShape::kRow, BuildingShape::kCourtyard}) {
      EXPECT_GT(shapes[shape], 0) << ShapeName(shape) << " " << seed;
    }
    for (const BuildingKind kind :
         {BuildingKind::kHouse, BuildingKind::kShed, BuildingKind::kApartment, BuildingKind::kTower, BuildingKind::kHall, BuildingKind::kGarage}) {
      EXPECT_GT(kinds[kind], 0) << KindName(kind) << " " << seed;
    }
    for (const RoofKind roof : {RoofKind::kFlat, RoofKind::kGable, RoofKind::kHip}) EXPECT_GT(roofs[roof], 3) << RoofName(roof) << " " << seed;
    EXPECT_GT(n_large_sheds, 2) << seed;
    EXPECT_GT(n_boxes, 1) << seed;
    // Wings are common, T-shapes are not.
    EXPECT_GT(shapes[BuildingShape::kL], static_cast<int>(outlines.size()) / 12) << seed;
    EXPECT_LT(shapes[BuildingShape::kT], shapes[BuildingShape::kL]) << seed;
  }
}

TEST(VariedTown, OutlinesAreCounterClockwiseAndAsLargeAsTheirParts) {
  for (const auto& [place, layout] : VariedPlaces()) {
    const std::vector<Building>& buildings = layout.contents().buildings;
    size_t next = 0;
    for (const Outline& outline : FindOutlines(buildings)) {
      ASSERT_EQ(outline.first, next);
      next += outline.n_parts;
      double sum_m2 = 0.0, holes_m2 = 0.0;
      for (size_t i = outline.first; i < next; ++i) {
        const Building& part = buildings[i];
        EXPECT_EQ(part.outline, buildings[outline.first].outline);
        EXPECT_GE(part.length_m, part.width_m - 1e-9);
        if (part.base_height_m == 0.0) sum_m2 += part.length_m * part.width_m;
        for (const Vector2d& corner : CornersOf(part)) {
          // A little towards the middle of the part, as corners are on the border.
          EXPECT_TRUE(IsInside(outline.walls, corner + 1e-3 * (part.centre - corner).normalized())) << VariedName(place) << " " << i;
        }
      }
      for (const Ring& hole : outline.holes) holes_m2 -= SignedArea(hole);
      EXPECT_GT(SignedArea(outline.walls), 0.0);
      EXPECT_GT(SignedArea(outline.roof), SignedArea(outline.walls) - 1e-6);
      EXPECT_NEAR(outline.area_m2, sum_m2, 1e-6) << VariedName(place) << " " << outline.first;
      EXPECT_NEAR(SignedArea(outline.walls) - holes_m2, sum_m2, 1e-6);
      EXPECT_GE(outline.length_m, outline.width_m);
    }
    EXPECT_EQ(next, buildings.size());
  }
}

TEST(VariedTown, OutlinesKeepClearOfEachOtherAndOfStreets) {
  for (const auto& [place, layout] : VariedPlaces()) {
    const std::vector<Building>& buildings = layout.contents().buildings;
    double nearest = std::numeric_limits<double>::infinity();
    int n_in_street = 0;
    for (const Building& b : buildings) {
      for (const Building& other : buildings) {
        if (other.outline == b.outline || (other.centre - b.centre).cwiseAbs().maxCoeff() > 60.0) continue;
        nearest = std::min(nearest, Clearance(b, other));
      }
      for (const Vector2d& corner : CornersOf(b)) {
        const GroundKind kind = layout.Sample(static_cast<float>(corner.x()), static_cast<float>(corner.y())).kind;
        n_in_street += kind == GroundKind::kRoad || kind == GroundKind::kPavement || kind == GroundKind::kField ? 1 : 0;
      }
    }
    EXPECT_GT(nearest, 0.5) << VariedName(place);
    EXPECT_EQ(n_in_street, 0) << VariedName(place);
  }
}

TEST(VariedTown, UpperPartsStandOnDecks) {
  for (const auto& [place, layout] : VariedPlaces()) {
    const std::vector<Building>& buildings = layout.contents().buildings;
    for (size_t i = 0; i < buildings.size(); ++i) {
      const Building& upper = buildings[i];
      if (upper.base_height_m == 0.0) continue;
      ASSERT_TRUE(upper.joined);
      const Building& podium = buildings[i - 1];
      EXPECT_EQ(upper.base_height_m, podium.eave_height_m);
      EXPECT_GT(upper.eave_height_m, podium.eave_height_m + 2.0);
      EXPECT_TRUE(podium.bare_roof);
      for (const Vector2d& corner : CornersOf(upper)) EXPECT_LT(podium.DistanceTo(corner), -1.0);
    }
  }
}

// Crowns and trunks are outside of all walls, and some crowns touch one.
TEST(VariedTown, TreesTouchWallsAndDoNotEnterThem) {
  for (const PlaceSpec& place : {Varied("town", 1), Varied("town", 4), Varied("hamlet", 2)}) {
    const CityLayout layout = VariedLayout(place);
    const CityContents& contents = layout.contents();
    int n_touching = 0;
    for (const Tree& tree : contents.trees) {
      Mesh mesh;
      AddTree(tree, 0, place.city.tree_detail, mesh);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Building& b : contents.buildings) {
        if (b.DistanceTo(tree.position) > 8.0) continue;
        for (const Eigen::Vector3f& vertex : mesh.position) nearest = std::min(nearest, b.DistanceTo(vertex.head<2>().cast<double>()));
      }
      EXPECT_GT(nearest, 0.0) << VariedName(place) << " tree at " << tree.position.transpose();
      n_touching += nearest < 0.05 ? 1 : 0;
    }
    EXPECT_GT(n_touching, place.name == "town" ? 10 : 0) << VariedName(place);
  }
}

TEST(VariedTown, CarsStandBesideBuildings) {
  for (const auto& [place, layout] : VariedPlaces()) {
    int n_in_building = 0;
    for (const Car& car : layout.contents().parked) {
      for (const Building& b : layout.contents().buildings) n_in_building += b.DistanceTo(car.position) < 0.9 ? 1 : 0;
    }
    EXPECT_GT(layout.contents().parked.size(), 3U);
    EXPECT_EQ(n_in_building, 0) << VariedName(place);
  }
}

TEST(VariedTown, SameSeedSameTown) {
  const CityLayout one = VariedLayout(Varied("town", 5)), same = VariedLayout(Varied("town", 5)), other = VariedLayout(Varied("town", 6));
  ASSERT_EQ(one.contents().buildings.size(), same.contents().buildings.size());
  for (size_t i = 0; i < one.contents().buildings.size(); ++i) EXPECT_EQ(one.contents().buildings[i].centre, same.contents().buildings[i].centre);
  ASSERT_EQ(one.contents().trees.size(), same.contents().trees.size());
  EXPECT_NE(one.contents().buildings[0].seed, other.contents().buildings[0].seed);
}

TEST(Landmark, IsOneTowerInTheMiddle) {
  for (const bool varied : {false, true}) {
    for (const std::string name : {"town", "hamlet"}) {
      SimulateOptions options;
      options.place = name;
      options.building_shapes = varied ? "varied" : "plain";
      options.tower_m = 200.0;
      options.altitudes = {300.0};
      const PlaceSpec place = ResolvePlace(options);
      const CityLayout layout = VariedLayout(place);
      int n_high = 0;
      for (const Building& b : layout.contents().buildings) {
        if (b.eave_height_m < 100.0) continue;
        ++n_high;
        EXPECT_EQ(b.eave_height_m, 200.0);
        EXPECT_EQ(b.ridge_height_m, 200.0);
        EXPECT_EQ(b.kind, BuildingKind::kTower);
        EXPECT_LT((b.centre - 0.5 * (place.area_min + place.area_max)).norm(), place.city.pitch_m);
      }
      EXPECT_EQ(n_high, 1) << name;
    }
  }
}

}  // namespace
}  // namespace skyquilt::simulate
