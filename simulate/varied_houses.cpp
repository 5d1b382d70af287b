// Fills a cell of a varied town with houses: with wings, in rows, with garages and sheds of several sizes.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "simulate/compound.h"
#include "simulate/plot_furnish.h"
#include "simulate/roof_overhangs.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector2d;

constexpr double kDriveStrip_m = 5.0;      // of the width of a plot, at its +x side
constexpr double kMargin_m = 0.6;          // beside the house at the other side
constexpr double kFreeStanding_m = 0.8;    // between outlines
constexpr double kBesideOverhang_m = 1.2;  // where roofs overhang

enum class HouseWish { kRectangle, kWing, kTee, kRow };

struct HousePlot {
  HouseWish wish = HouseWish::kRectangle;
  bool garage = false;
  double x = 0.0;  // of its edge, along the axes of the city
  double width_m = 17.0;
  double front = 1.0;  // +1: the street is on the +y side, otherwise -1
};

double Slope(double pitch_deg) {
  return std::tan(pitch_deg * std::numbers::pi / 180.0);
}

void PitchRoofed(Building& building, RoofKind roof, double eave_height_m, double pitch_deg) {
  building.roof = roof;
  building.eave_height_m = eave_height_m;
  building.ridge_height_m = eave_height_m + 0.5 * building.width_m * Slope(pitch_deg);
}

Building SingleHouse(double longest_m, base::Random& random) {
  Building house;
  house.kind = BuildingKind::kHouse;
  house.length_m = random.Uniform(9.0, std::max(9.2, std::min(13.0, longest_m)));
  house.width_m = random.Uniform(6.8, std::min(8.4, house.length_m));
  const double eave = random.UniformDouble() < 0.4 ? random.Uniform(2.9, 3.6) : random.Uniform(5.0, 6.2);
  const double pitch = random.Uniform(26.0, 42.0);
  const double pick = random.UniformDouble();
  if (pick < 0.12) {
    FlatRoofed(house, eave, 0.3);
    house.bare_roof = true;
  } else {
    PitchRoofed(house, pick < 0.5 ? RoofKind::kGable : RoofKind::kHip, eave, pitch);
  }
  house.seed = random.NextU32();
  return house;
}

std::vector<Building> HouseWithWing(HouseWish wish, double longest_m, base::Random& random) {
  Building main = SingleHouse(longest_m, random);
  main.length_m = std::min(main.length_m, 11.0);
  Wing wing;
  wing.width_m = random.Uniform(4.2, 5.2);
  wing.length_m = random.Uniform(std::max(wing.width_m, 4.8), 6.2);
  wing.eave_height_m = main.eave_height_m;
  const bool lower = random.UniformDouble() < 0.3;
  const double lower_eave = random.Uniform(2.7, 3.1);
  const double side = random.UniformDouble() < 0.5 ? -1.0 : 1.0;
  if (main.roof == RoofKind::kFlat) {
    // A deck is seen as another part only when its height differs.
    FlatRoofed(main, std::max(main.eave_height_m, 5.0), 0.3);
    wing.eave_height_m = lower_eave;
  } else if (lower && main.eave_height_m > 4.5) {
    wing.eave_height_m = lower_eave;
  }
  if (wish == HouseWish::kTee) return WithWing(main, wing, BuildingShape::kT);
  // Near the end of a hip the wing's roof would come out of the other slope.
  if (main.roof == RoofKind::kHip) main.roof = RoofKind::kGable;
  wing.along_m = 0.5 * side * (main.length_m - wing.width_m);
  return WithWing(main, wing, BuildingShape::kL);
}

std::vector<Building> HousesInRow(double longest_m, base::Random& random) {
  constexpr std::array<std::array<double, 2>, 3> kEaves = {{{2.8, 3.4}, {5.0, 5.6}, {6.6, 7.2}}};
  const size_t n = longest_m >= 24.0 && random.UniformDouble() < 0.6 ? 3 : 2;
  const double depth = random.Uniform(7.0, 7.8), pitch = random.Uniform(28.0, 40.0);
  std::vector<Building> houses;
  uint32_t storeys = random.Below(3);
  for (size_t i = 0; i < n; ++i) {
    Building house;
    house.kind = BuildingKind::kHouse;
    house.length_m = random.Uniform(8.0, std::min(10.5, longest_m / static_cast<double>(n)));
    house.width_m = random.UniformDouble() < 0.6 ? depth : random.Uniform(6.8, 8.0);
    storeys = (storeys + 1 + random.Below(2)) % 3;
    const double eave = random.Uniform(kEaves[storeys][0], kEaves[storeys][1]);
    PitchRoofed(house, RoofKind::kGable, eave, pitch);
    if (random.UniformDouble() < 0.2) FlatRoofed(house, eave, 0.3);
    house.seed = random.NextU32();
    houses.push_back(house);
  }
  return Row(std::move(houses));
}

// About the origin, the street at -y.
std::vector<Building> HousesFor(HouseWish wish, double longest_m, base::Random& random) {
  if (wish == HouseWish::kRow) return HousesInRow(longest_m, random);
  if (wish != HouseWish::kRectangle) {
    std::vector<Building> parts = HouseWithWing(wish, longest_m, random);
    // The wing is in the garden, or more rarely towards the street.
    if (random.UniformDouble() < 0.3) MoveParts({Vector2d::Zero(), 180.0}, Vector2d::Zero(), parts);
    return parts;
  }
  std::vector<Building> parts = {SingleHouse(longest_m, random)};
  if (random.UniformDouble() < 0.2) MoveParts({Vector2d::Zero(), 90.0}, Vector2d::Zero(), parts);
  return parts;
}

bool IsClear(const Building& building, double room_m, const CityContents& contents) {
  return std::all_of(contents.buildings.begin(), contents.buildings.end(),
                     [&](const Building& other) { return Clearance(building, other) >= room_m; });
}

// Puts a garage at the end of the drive, as near to the street as it is free there; how far its door is from the street.
std::optional<double> AddGarage(const HousePlot& plot, double street_y, double drive_x, double nearest_m, double depth_m, CityContents& contents,
                                base::Random& random) {
  Building garage;
  garage.kind = BuildingKind::kGarage;
  garage.length_m = random.Uniform(5.5, 6.2);
  garage.width_m = random.Uniform(2.9, 3.3);
  garage.yaw_deg = 90.0 + random.Uniform(-1.5, 1.5);
  const double garage_parapet_m = random.UniformDouble() < 0.3 ? 0.2 : 0.0;
  FlatRoofed(garage, random.Uniform(2.5, 2.9), garage_parapet_m);
  garage.seed = random.NextU32();
  for (double door = nearest_m; door + garage.length_m + 0.4 < depth_m; door += 0.5) {
    garage.centre = {drive_x, street_y - plot.front * (door + 0.5 * garage.length_m)};
    if (!IsClear(garage, kFreeStanding_m, contents)) continue;
    contents.buildings.push_back(garage);
    return door;
  }
  return std::nullopt;
}

void AddShed(const HousePlot& plot, double middle_y, CityContents& contents, base::Random& random) {
  Building shed;
  shed.kind = BuildingKind::kShed;
  const bool large = random.UniformDouble() < 0.65;
  shed.length_m = large ? random.Uniform(3.9, 4.8) : random.Uniform(2.8, 4.0);
  shed.width_m = large ? random.Uniform(2.6, 3.3) : random.Uniform(2.2, 2.8);
  shed.yaw_deg = random.Uniform(-4.0, 4.0);
  FlatRoofed(shed, random.Uniform(2.1, 2.7), 0.0);
  if (large && random.UniformDouble() < 0.35) {
    const double shed_pitch_deg = random.Uniform(20.0, 30.0);
    PitchRoofed(shed, RoofKind::kGable, random.Uniform(2.1, 2.4), shed_pitch_deg);
  }
  shed.seed = random.NextU32();
  // Not nearer to the neighbour's garden than its overhang.
  const double half_depth = 0.5 * shed.width_m + 0.07 * shed.length_m + kLargestShedOverhang_m;
  for (int attempt = 0; attempt < 6; ++attempt) {
    shed.centre = {plot.x + random.Uniform(3.2, plot.width_m - 3.2), middle_y + plot.front * (half_depth + random.Uniform(0.3, 1.2))};
    if (!IsClear(shed, kBesideOverhang_m, contents)) continue;
    contents.buildings.push_back(shed);
    return;
  }
}

void FurnishHousePlot(Cell& cell, const HousePlot& plot, CityContents& contents, base::Random& random) {
  const double street_y = plot.front > 0.0 ? cell.max.y() : cell.min.y();
  const double middle_y = 0.5 * (cell.min.y() + cell.max.y());
  const double plot_depth = std::abs(street_y - middle_y);
  const double room = plot.width_m - kDriveStrip_m;
  std::vector<Building> parts = HousesFor(plot.wish, room, random);
  const Vector2d size = SizeAround(parts);
  const double setback = std::min(random.Uniform(4.0, plot.garage ? 5.0 : 6.5), plot_depth - size.y() - 1.0);
  const double askew = plot.wish == HouseWish::kRow ? 1.0 : 3.5;
  const Vector2d middle(plot.x + kMargin_m + 0.5 * room, street_y - plot.front * (setback + 0.5 * size.y()));
  MoveParts({Vector2d::Zero(), (plot.front > 0.0 ? 180.0 : 0.0) + random.Uniform(-askew, askew)}, middle, parts);
  contents.buildings.insert(contents.buildings.end(), parts.begin(), parts.end());

  const double behind = setback + size.y();
  const double drive_x = middle.x() + 0.5 * size.x() + 1.9;
  double drive_end = setback + 0.7 * size.y();
  if (plot.garage) {
    // Beside the house there is not enough room for a gap on both sides.
    const std::optional<double> door = AddGarage(plot, street_y, drive_x, setback + 6.0, plot_depth, contents, random);
    if (door) drive_end = *door;
  }
  const double reach = 0.5 * cell.to_street_m;
  cell.pads.push_back(MakePad(PadKind::kDriveway, {drive_x, street_y - plot.front * (0.5 * drive_end - reach)}, {1.5, 0.5 * drive_end + reach}));
  for (const Building& part : parts) {
    if (part.joined && plot.wish != HouseWish::kRow) continue;
    cell.pads.push_back(MakePad(PadKind::kPath, {part.centre.x() - 0.2 * part.length_m, street_y - plot.front * (0.5 * setback - reach)},
                                {0.7, 0.5 * setback + reach}));
  }
  cell.pads.push_back(MakePad(PadKind::kTerrace, {middle.x(), street_y - plot.front * (behind + 1.4)}, {0.3 * size.x(), 1.6}));
  if (random.UniformDouble() < 0.4) {
    Car car;
    car.position = {drive_x, street_y - plot.front * random.Uniform(2.7, 4.0)};
    car.yaw_deg = 90.0 + random.Uniform(-3.0, 3.0);
    car.seed = random.NextU32();
    contents.parked.push_back(car);
  }
  if (random.UniformDouble() < 0.4) AddShed(plot, middle_y, contents, random);
  const auto n_trees = static_cast<int>(random.Below(4));
  for (int i = 0; i < n_trees; ++i) {
    const double y = street_y - plot.front * random.Uniform(std::min(behind, plot_depth - 2.0), plot_depth - 1.5);
    AddGardenTree({plot.x + random.Uniform(2.0, plot.width_m - 2.0), y}, 3.5, 8.0, contents, random);
  }
  if (random.UniformDouble() < 0.35) {
    AddGardenTree({plot.x + random.Uniform(2.0, 5.0), street_y - plot.front * 2.2}, 3.0, 4.5, contents, random);
  }
}

void FurnishEmptyPlot(const Cell& cell, const HousePlot& plot, CityContents& contents, base::Random& random) {
  for (int i = 0; i < 4; ++i) {
    const double y = 0.5 * (cell.min.y() + cell.max.y()) + plot.front * random.Uniform(3.0, 20.0);
    AddGardenTree({plot.x + random.Uniform(2.0, plot.width_m - 2.0), y}, 4.0, 9.0, contents, random);
  }
}

HouseWish RandomWish(base::Random& random) {
  const double pick = random.UniformDouble();
  return pick < 0.42 ? HouseWish::kWing : pick < 0.5 ? HouseWish::kTee : HouseWish::kRectangle;
}

}  // namespace

void FurnishVariedHouses(const CityPlan& plan, Cell& cell, CityContents& contents, base::Random& random) {
  const double width = cell.max.x() - cell.min.x();
  const int n_lots = std::max(1, static_cast<int>(std::lround(width / 17.0)));
  const double lot_width = width / n_lots;
  cell.lots_begin_m = cell.min.x();
  cell.lot_pitch_m = static_cast<float>(lot_width);
  // A showcase begins with one of each, as far as there are plots.
  std::vector<HousePlot> first;
  if (cell.showcase) first = {{HouseWish::kRectangle, true}, {HouseWish::kWing, false}, {HouseWish::kTee, false}};
  size_t n_built = 0;
  const size_t n_buildings_before = contents.buildings.size();
  const auto n_trees_before = static_cast<std::ptrdiff_t>(contents.trees.size());
  for (const double front : {-1.0, 1.0}) {
    const bool wants_row = random.UniformDouble() < 0.4;
    const bool has_row = n_lots >= 2 && (cell.showcase ? front < 0.0 : wants_row);
    const int row_at = has_row ? static_cast<int>(random.Below(static_cast<uint32_t>(n_lots - 1))) : -2;
    for (int lot = 0; lot < n_lots; ++lot) {
      HousePlot plot{RandomWish(random), random.UniformDouble() < 0.3};
      if (lot == row_at) plot = {HouseWish::kRow, false};
      const bool used = random.UniformDouble() < plan.lot_use;
      if (lot != row_at && n_built < first.size()) plot = first[n_built++];
      plot.x = cell.min.x() + lot * lot_width;
      plot.width_m = lot == row_at ? 2.0 * lot_width : lot_width;
      plot.front = front;
      if (used || cell.showcase) {
        FurnishHousePlot(cell, plot, contents, random);
      } else {
        FurnishEmptyPlot(cell, plot, contents, random);
      }
      if (lot == row_at) ++lot;
    }
  }
  // Trees that were there before a neighbour's house.
  const auto crowded = std::remove_if(contents.trees.begin() + n_trees_before, contents.trees.end(),
                                      [&](const Tree& tree) { return !TreeFits(tree, contents, n_buildings_before); });
  contents.trees.erase(crowded, contents.trees.end());
}

}  // namespace skyquilt::simulate
