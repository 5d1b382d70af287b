// Fills a cell between streets with its contents: houses with gardens, blocks of flats, towers on a plaza, or a park with a pond.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/city_layout.h"
#include "simulate/plot_furnish.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

// `front`: +1 when the street is on the +y side of the lot, otherwise -1.
void AddHouseLot(Cell& cell, double lot_x, double lot_width, double front, CityContents& contents, base::Random& random) {
  const double street_y = front > 0.0 ? cell.max.y() : cell.min.y();
  Building house;
  house.kind = BuildingKind::kHouse;
  house.length_m = random.Uniform(9.5, std::min(13.5, lot_width - 5.0));
  house.width_m = random.Uniform(7.2, std::min(9.2, house.length_m));
  house.eave_height_m = random.UniformDouble() < 0.45 ? random.Uniform(2.9, 3.6) : random.Uniform(5.0, 6.2);
  const double pitch = std::tan(random.Uniform(26.0, 42.0) * std::numbers::pi / 180.0);
  house.ridge_height_m = house.eave_height_m + 0.5 * house.width_m * pitch;
  house.roof = random.UniformDouble() < 0.65 ? RoofKind::kGable : RoofKind::kHip;
  const bool across = random.UniformDouble() < 0.25;
  house.yaw_deg = (across ? 90.0 : 0.0) + random.Uniform(-4.0, 4.0);
  if (random.UniformDouble() < 0.12) FlatRoofed(house, random.Uniform(3.0, 6.0), 0.3);
  const double depth = across ? house.length_m : house.width_m;
  const double breadth = across ? house.width_m : house.length_m;
  const double middle_y = 0.5 * (cell.min.y() + cell.max.y());
  // Room is left at the back, where a turned plot is small.
  const double setback = std::min(random.Uniform(4.0, 6.5), std::abs(street_y - middle_y) - depth - 1.0);
  // The drive, with its margins, is 5 m wide.
  house.centre = {lot_x + 0.6 + 0.5 * (lot_width - 5.0), street_y - front * (setback + 0.5 * depth)};
  house.seed = random.NextU32();
  contents.buildings.push_back(house);

  const double drive_x = house.centre.x() + 0.5 * breadth + 1.9;
  const double drive_half = 0.5 * (setback + 0.7 * depth);
  const double reach = 0.5 * cell.to_street_m;
  cell.pads.push_back(MakePad(PadKind::kDriveway, {drive_x, street_y - front * (drive_half - reach)}, {1.5, drive_half + reach}));
  cell.pads.push_back(
      MakePad(PadKind::kPath, {house.centre.x() - 0.2 * breadth, street_y - front * (0.5 * setback - reach)}, {0.7, 0.5 * setback + reach}));
  const double behind = street_y - front * (setback + depth);
  cell.pads.push_back(
      MakePad(PadKind::kTerrace, {house.centre.x(), behind - front * 1.6}, {0.32 * breadth, 1.8}, house.yaw_deg - (across ? 90.0 : 0.0)));
  if (random.UniformDouble() < 0.4) {
    Car car;
    car.position = {drive_x, street_y - front * random.Uniform(2.7, 4.0)};
    car.yaw_deg = 90.0 + random.Uniform(-3.0, 3.0);
    car.seed = random.NextU32();
    contents.parked.push_back(car);
  }
  if (random.UniformDouble() < 0.3) {
    Building shed;
    shed.kind = BuildingKind::kShed;
    shed.length_m = random.Uniform(2.8, 4.0);
    shed.width_m = random.Uniform(2.2, 2.8);
    shed.yaw_deg = random.Uniform(-8.0, 8.0);
    FlatRoofed(shed, random.Uniform(2.1, 2.6), 0.0);
    shed.centre = {lot_x + random.Uniform(3.0, lot_width - 3.0), middle_y + front * 2.6};
    shed.seed = random.NextU32();
    if ((shed.centre - house.centre).norm() > 9.5) contents.buildings.push_back(shed);
  }
  const int n_trees = static_cast<int>(random.Below(4));
  for (int i = 0; i < n_trees; ++i) {
    const double y = random.Uniform(std::min(middle_y + front * 1.5, behind), std::max(middle_y + front * 1.5, behind));
    AddGardenTree({lot_x + random.Uniform(2.0, lot_width - 2.0), y}, 3.5, 8.0, contents, random);
  }
  if (random.UniformDouble() < 0.35) AddGardenTree({lot_x + random.Uniform(2.0, 5.0), street_y - front * 2.2}, 3.0, 4.5, contents, random);
}

void FurnishHouses(const CityPlan& plan, Cell& cell, CityContents& contents, base::Random& random) {
  const double width = cell.max.x() - cell.min.x();
  const int n_lots = std::max(1, static_cast<int>(std::lround(width / 17.0)));
  const double lot_width = width / n_lots;
  cell.lots_begin_m = cell.min.x();
  cell.lot_pitch_m = static_cast<float>(lot_width);
  for (const double front : {-1.0, 1.0}) {
    for (int lot = 0; lot < n_lots; ++lot) {
      const double lot_x = cell.min.x() + lot * lot_width;
      if (random.UniformDouble() < plan.lot_use) {
        AddHouseLot(cell, lot_x, lot_width, front, contents, random);
      } else {
        for (int i = 0; i < 4; ++i) {
          const double y = 0.5 * (cell.min.y() + cell.max.y()) + front * random.Uniform(3.0, 20.0);
          AddGardenTree({lot_x + random.Uniform(2.0, lot_width - 2.0), y}, 4.0, 9.0, contents, random);
        }
      }
    }
  }
}

void FurnishFlats(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  for (const double side : {-1.0, 1.0}) {
    Building slab;
    slab.kind = BuildingKind::kApartment;
    slab.length_m = random.Uniform(0.52, 0.68) * size.x();
    slab.width_m = random.Uniform(10.5, 12.5);
    slab.yaw_deg = random.Uniform(-2.0, 2.0);
    const double slab_parapet_m = random.Uniform(0.4, 0.7);
    FlatRoofed(slab, 3.0 * static_cast<double>(3 + random.Below(4)) + 0.6, slab_parapet_m);
    slab.centre = {middle.x() + random.Uniform(-0.08, 0.08) * size.x(), middle.y() + side * (0.5 * size.y() - 5.0 - 0.5 * slab.width_m)};
    slab.seed = random.NextU32();
    contents.buildings.push_back(slab);
    cell.pads.push_back(MakePad(PadKind::kPath, {slab.centre.x(), slab.centre.y() + side * (0.5 * slab.width_m + 2.4)}, {0.5 * slab.length_m, 0.9}));
  }
  AddParking(cell, {middle.x() - 0.08 * size.x(), middle.y()}, {0.34 * size.x(), 8.0}, 0.5, contents, random);
  cell.pads.push_back(MakePad(PadKind::kDriveway, {cell.max.x() - 0.12 * size.x(), middle.y()}, {0.14 * size.x(), 2.6}));
  for (int i = 0; i < 14; ++i) {
    const double x = random.Uniform(cell.min.x() + 2.0, cell.max.x() - 2.0);
    const double y = random.Uniform(cell.min.y() + 2.0, cell.max.y() - 2.0);
    if (std::abs(y - middle.y()) > 10.5) AddGardenTree({x, y}, 5.0, 10.0, contents, random);
  }
}

void FurnishTowers(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  cell.pads.push_back(MakePad(PadKind::kPlaza, middle, {0.5 * size.x() - 2.5, 0.5 * size.y() - 2.5}));
  for (const double side : {-1.0, 1.0}) {
    Building tower;
    tower.kind = BuildingKind::kTower;
    tower.length_m = random.Uniform(15.0, 19.0);
    tower.width_m = random.Uniform(13.0, 15.0);
    tower.yaw_deg = random.UniformDouble() < 0.5 ? random.Uniform(-3.0, 3.0) : 90.0 + random.Uniform(-3.0, 3.0);
    const double tower_parapet_m = random.Uniform(0.6, 1.0);
    FlatRoofed(tower, 3.1 * static_cast<double>(6 + random.Below(4)) + 1.0, tower_parapet_m);
    tower.centre = middle + Vector2d(side * 0.27 * size.x(), side * random.Uniform(0.12, 0.2) * size.y());
    tower.seed = random.NextU32();
    contents.buildings.push_back(tower);
  }
  Building hall;
  hall.kind = BuildingKind::kHall;
  hall.length_m = random.Uniform(15.0, 18.0);
  hall.width_m = random.Uniform(10.0, 13.0);
  hall.yaw_deg = random.Uniform(-2.0, 2.0);
  FlatRoofed(hall, random.Uniform(4.5, 6.0), 0.4);
  hall.centre = middle + Vector2d(-0.25 * size.x(), 0.28 * size.y());
  hall.seed = random.NextU32();
  contents.buildings.push_back(hall);
  AddParking(cell, {middle.x() + 0.24 * size.x(), middle.y() - 0.27 * size.y()}, {0.2 * size.x(), 7.6}, 0.6, contents, random);
  for (double x = cell.min.x() + 4.0; x < cell.max.x() - 3.0; x += 7.5) {
    AddGardenTree({x, cell.min.y() + 4.0}, 5.0, 7.0, contents, random);
    AddGardenTree({x, cell.max.y() - 4.0}, 5.0, 7.0, contents, random);
  }
}

void FurnishPark(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  Pond pond;
  const double pond_y = random.Uniform(0.1, 0.2) * size.y(), pond_x = random.Uniform(0.12, 0.2) * size.x();
  pond.centre = middle + Vector2d(pond_x, pond_y);
  pond.radii = {random.Uniform(8.0, 11.0), random.Uniform(6.0, 8.5)};
  contents.ponds.push_back(pond);
  const double diagonal = 0.5 * size.norm();
  cell.pads.push_back(MakePad(PadKind::kPath, middle - Vector2d(0.16 * size.x(), 0.0), {1.1, 0.5 * size.y()}, random.Uniform(-6.0, 6.0)));
  cell.pads.push_back(MakePad(PadKind::kPath, middle - Vector2d(0.0, 0.18 * size.y()), {0.98 * diagonal * 0.7, 1.1}, random.Uniform(-5.0, 5.0)));
  const int n_trees = static_cast<int>(size.x() * size.y() / 75.0);
  for (int i = 0; i < n_trees; ++i) {
    const double at_y = random.Uniform(cell.min.y() + 3.0, cell.max.y() - 3.0), at_x = random.Uniform(cell.min.x() + 3.0, cell.max.x() - 3.0);
    const Vector2d at(at_x, at_y);
    AddGardenTree(at, 6.0, 12.0, contents, random);
  }
}

void FurnishWood(const Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const int n_trees = static_cast<int>(size.x() * size.y() / 75.0);
  for (int i = 0; i < n_trees; ++i) {
    const double at_y = random.Uniform(cell.min.y() + 1.0, cell.max.y() - 1.0), at_x = random.Uniform(cell.min.x() + 1.0, cell.max.x() - 1.0);
    const Vector2d at(at_x, at_y);
    AddGardenTree(at, 6.0, kHighestInWood_m, contents, random);
  }
}

// One high tower on a plaza with trees along the streets.
void FurnishLandmark(Cell& cell, CityContents& contents, base::Random& random) {
  const Vector2d size = cell.max - cell.min;
  const Vector2d middle = 0.5 * (cell.min + cell.max);
  cell.pads.push_back(MakePad(PadKind::kPlaza, middle, {0.5 * size.x() - 2.5, 0.5 * size.y() - 2.5}));
  Building tower;
  tower.kind = BuildingKind::kTower;
  tower.length_m = random.Uniform(22.0, 26.0);
  tower.width_m = random.Uniform(18.0, 21.0);
  tower.yaw_deg = random.Uniform(-3.0, 3.0);
  FlatRoofed(tower, cell.landmark_m, 1.0);
  tower.centre = middle;
  tower.seed = random.NextU32();
  contents.buildings.push_back(tower);
  for (double x = cell.min.x() + 4.0; x < cell.max.x() - 3.0; x += 7.5) {
    for (const double y : {cell.min.y() + 4.0, cell.max.y() - 4.0}) AddGardenTree({x, y}, 5.0, 7.0, contents, random);
  }
}

// Along the axes of the city.
void FurnishPlot(const CityPlan& plan, Cell& cell, CityContents& contents, base::Random& random) {
  switch (cell.kind) {
    case CellKind::kHouses:
      plan.varied ? FurnishVariedHouses(plan, cell, contents, random) : FurnishHouses(plan, cell, contents, random);
      break;
    case CellKind::kFlats:
      plan.varied ? FurnishVariedFlats(cell, contents, random) : FurnishFlats(cell, contents, random);
      break;
    case CellKind::kTowers:
      if (cell.landmark_m > 0.0) {
        FurnishLandmark(cell, contents, random);
      } else {
        plan.varied ? FurnishVariedTowers(cell, contents, random) : FurnishTowers(cell, contents, random);
      }
      break;
    case CellKind::kPark:
      FurnishPark(cell, contents, random);
      break;
    case CellKind::kWood:
      FurnishWood(cell, contents, random);
      break;
    case CellKind::kField:
      break;
  }
}

// Whether a point is inside the cell, at least this far from its edge.
bool Inside(const Cell& cell, const Vector2d& point, double margin_m) {
  return (point - cell.min).minCoeff() >= margin_m && (cell.max - point).minCoeff() >= margin_m;
}

bool Inside(const Cell& cell, const Building& building) {
  const Vector2d u = 0.5 * building.length_m * building.Axis();
  const Vector2d v = 0.5 * building.width_m * Vector2d(-building.Axis().y(), building.Axis().x());
  for (const Vector2d& corner : {Vector2d(u + v), Vector2d(u - v), Vector2d(-u - v), Vector2d(v - u)}) {
    if (!Inside(cell, building.centre + corner, 0.0)) return false;
  }
  return true;
}

// False, and nothing is changed, when a building would reach into the street.
bool FurnishTurned(const CityPlan& plan, const PlaneTurn& turn, Cell& cell, CityContents& contents, base::Random random) {
  Cell plot = cell;
  if (cell.kind == CellKind::kHouses) {
    // The largest square of this turn inside the cell.
    const Vector2d middle = 0.5 * (cell.min + cell.max);
    const double share = 1.0 / (turn.cosine() + std::abs(turn.sine()));
    plot.min = middle + share * (cell.min - middle);
    plot.max = middle + share * (cell.max - middle);
    plot.to_street_m = 10.0;  // more than enough; pavements are not covered
  }
  CityContents turned;
  FurnishPlot(plan, plot, turned, random);
  TurnAll(turn, turned);
  if (!std::all_of(turned.buildings.begin(), turned.buildings.end(), [&](const Building& b) { return Inside(cell, b); })) return false;
  std::erase_if(turned.trees, [&](const Tree& tree) { return !Inside(cell, tree.position, 1.0); });
  std::erase_if(turned.parked, [&](const Car& car) { return !Inside(cell, car.position, 2.0); });
  for (PavedArea& pad : plot.pads) {
    pad.centre = turn.Turned(pad.centre.cast<double>()).cast<float>();
    const Vector2d axis = turn.TurnedDirection(Vector2d(static_cast<double>(pad.cosine), static_cast<double>(pad.sine)));
    pad.cosine = static_cast<float>(axis.x());
    pad.sine = static_cast<float>(axis.y());
  }
  plot.min = cell.min;
  plot.max = cell.max;
  plot.turn = turn;
  cell = plot;
  contents.buildings.insert(contents.buildings.end(), turned.buildings.begin(), turned.buildings.end());
  contents.trees.insert(contents.trees.end(), turned.trees.begin(), turned.trees.end());
  contents.parked.insert(contents.parked.end(), turned.parked.begin(), turned.parked.end());
  return true;
}

}  // namespace

bool TreeFits(const Tree& tree, const CityContents& contents, size_t first_building) {
  for (size_t i = first_building; i < contents.buildings.size(); ++i) {
    if (contents.buildings[i].DistanceTo(tree.position) < 1.15 * tree.crown_radius_m + 0.6) return false;
  }
  for (const Pond& pond : contents.ponds) {
    if (pond.Radius(tree.position.x(), tree.position.y()) < 1.3) return false;
  }
  return true;
}

void TurnAll(const PlaneTurn& turn, CityContents& contents) {
  for (Building& building : contents.buildings) {
    building.centre = turn.Turned(building.centre);
    building.yaw_deg = turn.TurnedYaw(building.yaw_deg);
  }
  for (Tree& tree : contents.trees) tree.position = turn.Turned(tree.position);
  for (Car& car : contents.parked) {
    car.position = turn.Turned(car.position);
    car.yaw_deg = turn.TurnedYaw(car.yaw_deg);
  }
  for (Pond& pond : contents.ponds) {
    pond.centre = turn.Turned(pond.centre);
    pond.axis = turn.TurnedDirection(pond.axis);
  }
}

void FurnishCell(const CityPlan& plan, double turn_deg, Cell& cell, CityContents& contents, base::Random& random) {
  const bool turnable = cell.kind == CellKind::kHouses || cell.kind == CellKind::kFlats || cell.kind == CellKind::kTowers;
  if (turn_deg != 0.0 && turnable && FurnishTurned(plan, {0.5 * (cell.min + cell.max), turn_deg}, cell, contents, random)) return;
  FurnishPlot(plan, cell, contents, random);
}

}  // namespace skyquilt::simulate
