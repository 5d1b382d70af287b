// Fills cells of a varied town with large buildings: courtyards, flats with a set-back storey, towers on podiums and halls.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/compound.h"
#include "simulate/plot_furnish.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr double kStorey_m = 3.0;

double DeckOf(uint32_t storeys) {
  return kStorey_m * static_cast<double>(storeys) + 0.6;
}

void PutCompound(std::vector<Building> parts, const Vector2d& place, double yaw_deg, CityContents& contents) {
  MoveParts({Vector2d::Zero(), yaw_deg}, place, parts);
  contents.buildings.insert(contents.buildings.end(), parts.begin(), parts.end());
}

void FurnishCourtyard(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  Building wing;
  wing.kind = BuildingKind::kApartment;
  wing.parapet_height_m = random.Uniform(0.4, 0.7);
  wing.seed = random.NextU32();
  const double depth = random.Uniform(9.0, 10.4);
  const double size_y = random.Uniform(3.0 * depth + 0.5, 33.0), size_x = random.Uniform(37.0, 40.0);
  const Vector2d size(size_x, size_y);
  const uint32_t storeys = 3 + random.Below(2);
  std::array<double, 4> heights{};
  for (double& height : heights) height = DeckOf(storeys);
  // One wing is a storey higher or lower, or none.
  const uint32_t other = random.Below(6);
  if (other < 4) heights[other] = DeckOf(random.UniformDouble() < 0.5 ? storeys + 1 : storeys - 1);
  PutCompound(Courtyard(wing, size, depth, heights), middle, random.Uniform(-1.0, 1.0), contents);
  for (const double side : {-1.0, 1.0}) {
    cell.pads.push_back(MakePad(PadKind::kPath, {middle.x(), middle.y() + side * (0.5 * size.y() + 2.4)}, {0.5 * size.x(), 0.9}));
    cell.pads.push_back(MakePad(PadKind::kPath, {middle.x() + side * (0.5 * size.x() + 2.4), middle.y()}, {0.9, 0.5 * size.y()}));
  }
  cell.pads.push_back(MakePad(PadKind::kTerrace, middle, {0.2 * size.x() - 2.0, 2.0}));
  const double tree_y = random.Uniform(1.0, 2.0), tree_x = random.Uniform(-4.0, 4.0);
  AddGardenTree(middle + Vector2d(tree_x, tree_y), 5.0, 7.0, contents, random);
  for (int i = 0; i < 16; ++i) {
    AddGardenTree({random.Uniform(cell.min.x() + 2.0, cell.max.x() - 2.0), random.Uniform(cell.min.y() + 2.0, cell.max.y() - 2.0)}, 4.0, 8.0,
                  contents, random);
  }
}

// Two slabs of flats with a car park between them; one has a set-back top storey.
void FurnishSlabs(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  const double with_setback = random.UniformDouble() < 0.5 ? -1.0 : 1.0;
  for (const double side : {-1.0, 1.0}) {
    Building slab;
    slab.kind = BuildingKind::kApartment;
    slab.length_m = random.Uniform(0.52, 0.68) * size.x();
    slab.width_m = random.Uniform(11.0, 12.5);
    const double parapet_m = random.Uniform(0.4, 0.7);
    FlatRoofed(slab, DeckOf(3 + random.Below(3)), parapet_m);
    slab.seed = random.NextU32();
    const Vector2d place(middle.x() + random.Uniform(-0.08, 0.08) * size.x(), middle.y() + side * (0.5 * size.y() - 5.0 - 0.5 * slab.width_m));
    const double yaw_deg = random.Uniform(-2.0, 2.0);
    const double top_y = slab.width_m - random.Uniform(3.6, 4.6), top_x = slab.length_m - random.Uniform(5.0, 9.0);
    const Vector2d top(top_x, top_y);
    const Vector2d offset(random.Uniform(-1.0, 1.0), 0.0);
    std::vector<Building> parts = {slab};
    if (side == with_setback) parts = WithSetback(slab, top, offset, slab.eave_height_m + kStorey_m + 0.3);
    PutCompound(std::move(parts), place, yaw_deg, contents);
    cell.pads.push_back(MakePad(PadKind::kPath, {place.x(), place.y() + side * (0.5 * slab.width_m + 2.4)}, {0.5 * slab.length_m, 0.9}));
  }
  AddParking(cell, {middle.x() - 0.08 * size.x(), middle.y()}, {0.34 * size.x(), 8.0}, 0.5, contents, random);
  cell.pads.push_back(MakePad(PadKind::kDriveway, {cell.max.x() - 0.12 * size.x(), middle.y()}, {0.14 * size.x(), 2.6}));
  for (int i = 0; i < 14; ++i) {
    const double at_y = random.Uniform(cell.min.y() + 2.0, cell.max.y() - 2.0), at_x = random.Uniform(cell.min.x() + 2.0, cell.max.x() - 2.0);
    const Vector2d at(at_x, at_y);
    if (std::abs(at.y() - middle.y()) > 10.5) AddGardenTree(at, 5.0, 10.0, contents, random);
  }
}

}  // namespace

void FurnishVariedFlats(Cell& cell, CityContents& contents, base::Random& random) {
  const bool courtyard = random.UniformDouble() < 0.5;
  if (courtyard || cell.showcase) {
    FurnishCourtyard(cell, contents, random);
  } else {
    FurnishSlabs(cell, contents, random);
  }
}

void FurnishVariedTowers(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  cell.pads.push_back(MakePad(PadKind::kPlaza, middle, {0.5 * size.x() - 2.5, 0.5 * size.y() - 2.5}));
  const auto TowerHeight = [&random] { return 3.1 * static_cast<double>(6 + random.Below(4)) + 1.0; };

  Building podium;
  podium.kind = BuildingKind::kTower;
  podium.length_m = random.Uniform(22.0, 24.0);
  podium.width_m = random.Uniform(17.0, 19.0);
  podium.seed = random.NextU32();
  const double parapet_m = random.Uniform(0.6, 1.0);
  FlatRoofed(podium, random.Uniform(4.5, 8.0), parapet_m);
  const double upper_y = random.Uniform(12.2, 13.0), upper_x = random.Uniform(16.0, 16.8);
  const Vector2d upper(upper_x, upper_y);
  const double offset_y = random.Uniform(-0.6, 0.6), offset_x = random.Uniform(-1.0, 1.0);
  const Vector2d offset(offset_x, offset_y);
  PutCompound(WithSetback(podium, upper, offset, TowerHeight()), middle - 0.19 * size, random.Uniform(-1.5, 1.5), contents);

  Building tower;
  tower.kind = BuildingKind::kTower;
  tower.length_m = random.Uniform(16.0, 18.0);
  tower.width_m = random.Uniform(13.0, 15.0);
  FlatRoofed(tower, TowerHeight(), random.Uniform(0.6, 1.0));
  tower.seed = random.NextU32();
  const double tower_yaw_deg = random.Uniform(-3.0, 3.0);
  PutCompound({tower}, middle + Vector2d(0.28 * size.x(), random.Uniform(0.14, 0.2) * size.y()), tower_yaw_deg, contents);

  Building hall;
  hall.kind = BuildingKind::kHall;
  hall.length_m = random.Uniform(16.0, 18.5);
  hall.width_m = random.Uniform(10.0, 13.0);
  FlatRoofed(hall, random.Uniform(4.5, 6.0), 0.4);
  if (random.UniformDouble() < 0.4) {
    hall.roof = RoofKind::kGable;
    hall.parapet_height_m = 0.0;
    hall.ridge_height_m = hall.eave_height_m + 0.5 * hall.width_m * std::tan(random.Uniform(10.0, 16.0) * std::numbers::pi / 180.0);
  }
  hall.seed = random.NextU32();
  PutCompound({hall}, middle + Vector2d(-0.25 * size.x(), 0.28 * size.y()), random.Uniform(-2.0, 2.0), contents);

  AddParking(cell, {middle.x() + 0.24 * size.x(), middle.y() - 0.27 * size.y()}, {0.19 * size.x(), 7.6}, 0.6, contents, random);
  for (double x = cell.min.x() + 4.0; x < cell.max.x() - 3.0; x += 7.5) {
    for (const double y : {cell.min.y() + 4.0, cell.max.y() - 4.0}) AddGardenTree({x, y}, 5.0, 7.0, contents, random);
  }
}

}  // namespace skyquilt::simulate
