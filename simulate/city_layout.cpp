#include "simulate/city_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulate/noise.h"
#include "simulate/outline.h"
#include "simulate/plot_furnish.h"
#include "simulate/roof_overhangs.h"
#include "simulate/wall_trees.h"

namespace skyquilt::simulate {
namespace {

constexpr double kCurbToCentre = static_cast<double>(kRoadHalfWidth + kPavementWidth);

}  // namespace

CityLayout::CityLayout(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, uint32_t seed)
    : turn_(0.5 * (ground_min + ground_max), plan.yaw_deg), pitch_(static_cast<float>(plan.pitch_m)), phase_(plan.phase.cast<float>()) {
  AddCells(plan);
  base::Random random(seed, 1);
  ChooseKinds(plan, random);
  ChooseWoods(plan, seed);
  FurnishCells(plan, seed);
  AddStreetLife(plan, random);
  TurnContents(ground_min, ground_max);
  if (plan.varied) {
    DrawOverhangs(contents_.buildings);
    RemoveTreesAtRoofs(plan.tree_detail, contents_);
    AddWallTrees(plan, seed);
  }
  AddFieldTrees(plan, ground_min, ground_max, random);
  if (plan.tree_density < 1.0) ThinTrees(plan.tree_density, contents_);
  base::Random street_random(seed, 8);
  if (plan.bridge) AddBridge(street_random);
  if (plan.trucks > 0) AddTrucks(plan, street_random);
  if (plan.lamps > 0) {
    base::Random lamp_random(seed, 9);
    AddLamps(plan, lamp_random);
  }
}

void CityLayout::AddCells(const CityPlan& plan) {
  // The streets around the built-up rectangle, which the axes of the city may cross at any angle.
  Eigen::Vector2d low = turn_.TurnedBack(plan.min), high = low;
  for (const Eigen::Vector2d& corner : {plan.max, Eigen::Vector2d(plan.min.x(), plan.max.y()), Eigen::Vector2d(plan.max.x(), plan.min.y())}) {
    low = low.cwiseMin(turn_.TurnedBack(corner));
    high = high.cwiseMax(turn_.TurnedBack(corner));
  }
  first_x_ = static_cast<int>(std::ceil((low.x() - plan.phase.x()) / plan.pitch_m)) - 1;
  last_x_ = static_cast<int>(std::floor((high.x() - plan.phase.x()) / plan.pitch_m)) + 1;
  first_y_ = static_cast<int>(std::ceil((low.y() - plan.phase.y()) / plan.pitch_m)) - 1;
  last_y_ = static_cast<int>(std::floor((high.y() - plan.phase.y()) / plan.pitch_m)) + 1;
  columns_ = last_x_ - first_x_;
  rows_ = last_y_ - first_y_;
  for (int j = 0; j < rows_; ++j) {
    for (int i = 0; i < columns_; ++i) {
      Cell cell;
      cell.min = plan.phase + plan.pitch_m * Eigen::Vector2d(first_x_ + i, first_y_ + j) + Eigen::Vector2d::Constant(kCurbToCentre);
      cell.max = cell.min + Eigen::Vector2d::Constant(plan.pitch_m - 2.0 * kCurbToCentre);
      cells_.push_back(cell);
    }
  }
}

void CityLayout::FurnishCells(const CityPlan& plan, uint32_t seed) {
  // A line through the middle of the city divides it into two districts.
  base::Random district_random(seed, 4);
  const Eigen::Vector2d across = PlaneTurn({0.0, 0.0}, district_random.Uniform(0.0, 360.0)).TurnedDirection(Eigen::Vector2d::UnitX());
  const Eigen::Vector2d city_middle = turn_.TurnedBack(0.5 * (plan.min + plan.max));
  for (size_t i = 0; i < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    const Eigen::Vector2d in_city = 0.5 * (cell.min + cell.max);
    // Cells outside the built-up rectangle are meadows.
    const Eigen::Vector2d middle = turn_.Turned(in_city);
    if ((middle - plan.min).minCoeff() < -0.25 * plan.pitch_m || (plan.max - middle).minCoeff() < -0.25 * plan.pitch_m) cell.kind = CellKind::kField;
    base::Random cell_random(seed, 100 + i);
    const size_t n_trees_before = contents_.trees.size();
    FurnishCell(plan, across.dot(in_city - city_middle) > 0.0 ? plan.district_turn_deg : 0.0, cell, contents_, cell_random);
    if (plan.tree_density > 1.0) MultiplyTrees(plan.tree_density, n_trees_before, cell, contents_, cell_random);
  }
  NumberOutlines(contents_.buildings);
}

void CityLayout::TurnContents(const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max) {
  TurnAll(turn_, contents_);
  // A street along the edge of the ground keeps both sides.
  const auto beyond = [&](const auto& object) {
    const Eigen::Vector2d& at = object.position;
    return std::max((ground_min - at).maxCoeff(), (at - ground_max).maxCoeff()) > kCurbToCentre;
  };
  std::erase_if(contents_.trees, beyond);
  std::erase_if(contents_.parked, beyond);
}

void CityLayout::AddWallTrees(const CityPlan& plan, uint32_t seed) {
  base::Random random(seed, 6);
  AddTreesAtWalls(
      plan.tree_detail,
      [this](const Eigen::Vector2d& at) { return Sample(static_cast<float>(at.x()), static_cast<float>(at.y())).kind == GroundKind::kCell; },
      contents_, random);
}

void CityLayout::ChooseKinds(const CityPlan& plan, base::Random& random) {
  // The middle of the city gets one cell of each rarer kind, so that they exist for every seed.
  std::vector<size_t> by_distance(cells_.size());
  for (size_t i = 0; i < by_distance.size(); ++i) by_distance[i] = i;
  const Eigen::Vector2d middle = turn_.TurnedBack(0.5 * (plan.min + plan.max));
  std::stable_sort(by_distance.begin(), by_distance.end(), [&](size_t a, size_t b) {
    return (0.5 * (cells_[a].min + cells_[a].max) - middle).norm() < (0.5 * (cells_[b].min + cells_[b].max) - middle).norm();
  });
  for (Cell& cell : cells_) {
    const double pick = random.UniformDouble();
    if (pick < plan.tower_share) {
      cell.kind = CellKind::kTowers;
    } else if (pick < plan.tower_share + plan.flats_share) {
      cell.kind = CellKind::kFlats;
    } else if (pick < plan.tower_share + plan.flats_share + plan.park_share) {
      cell.kind = CellKind::kPark;
    }
  }
  ChooseSpecialCells(plan, by_distance, random);
}

void CityLayout::ChooseSpecialCells(const CityPlan& plan, const std::vector<size_t>& by_distance, base::Random& random) {
  size_t houses = 0;
  if (by_distance.size() >= 9) {
    const std::array<std::pair<double, CellKind>, 3> wanted = {
        {{plan.tower_share, CellKind::kTowers}, {plan.park_share, CellKind::kPark}, {plan.flats_share, CellKind::kFlats}}};
    const size_t first = 1 + random.Below(2);
    size_t place = first;
    for (const auto& [share, kind] : wanted) {
      Cell& cell = cells_[by_distance[place]];
      if (share > 0.0) cell.kind = kind;
      cell.showcase = true;
      place += 2;
    }
    cells_[by_distance[0]].kind = CellKind::kHouses;
    if (plan.tower_m > 0.0) houses = 3 - first;
  } else if (plan.tower_m > 0.0) {
    houses = std::min<size_t>(1, by_distance.size() - 1);
  }
  if (plan.varied) {
    cells_[by_distance[houses]].kind = CellKind::kHouses;
    cells_[by_distance[houses]].showcase = true;
  }
  if (plan.tower_m > 0.0) {
    cells_[by_distance[0]].kind = CellKind::kTowers;
    cells_[by_distance[0]].landmark_m = plan.tower_m;
  }
}

void CityLayout::ChooseWoods(const CityPlan& plan, uint32_t seed) {
  for (size_t i = 0; i < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    if (cell.kind == CellKind::kPark || cell.landmark_m > 0.0) continue;
    if (static_cast<double>(HashUnit(static_cast<int>(i), 8, seed)) >= plan.building_share) cell.kind = CellKind::kWood;
  }
}

void CityLayout::AddStreetLife(const CityPlan& plan, base::Random& random) {
  const double kerb = static_cast<double>(kRoadHalfWidth);
  const auto Along = [&](bool eastward, double line, double from, double to) {
    for (double at = from; at < to; at += 7.0) {
      for (const double side : {-1.0, 1.0}) {
        const double pick = random.UniformDouble();
        const double jitter = random.Uniform(-1.0, 1.0);
        const auto Point = [&](double across) {
          return eastward ? Eigen::Vector2d(at + jitter, line + side * across) : Eigen::Vector2d(line + side * across, at + jitter);
        };
        if (pick < std::min(0.13 * plan.trees * std::max(plan.tree_density, 1.0), 0.5)) {
          Tree tree;
          tree.position = Point(kerb + 1.3);
          tree.height_m = random.Uniform(4.5, 7.5);
          tree.crown_radius_m = 0.30 * tree.height_m;
          tree.seed = random.NextU32();
          if (TreeFits(tree, contents_, 0)) contents_.trees.push_back(tree);
        } else if (pick > 0.86) {
          Car car;
          car.position = Point(kerb - 1.15);
          car.yaw_deg = (eastward ? 0.0 : 90.0) + (side > 0.0 ? 180.0 : 0.0) + random.Uniform(-2.0, 2.0);
          car.seed = random.NextU32();
          contents_.parked.push_back(car);
        }
      }
    }
  };
  for (int j = first_y_; j <= last_y_; ++j) {
    for (int i = first_x_; i < last_x_; ++i) {
      const Eigen::Vector2d crossing = plan.phase + plan.pitch_m * Eigen::Vector2d(i, j);
      Along(true, crossing.y(), crossing.x() + 13.0, crossing.x() + plan.pitch_m - 13.0);
    }
  }
  for (int i = first_x_; i <= last_x_; ++i) {
    for (int j = first_y_; j < last_y_; ++j) {
      const Eigen::Vector2d crossing = plan.phase + plan.pitch_m * Eigen::Vector2d(i, j);
      Along(false, crossing.x(), crossing.y() + 13.0, crossing.y() + plan.pitch_m - 13.0);
    }
  }
}

void CityLayout::AddFieldTrees(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, base::Random& random) {
  const Eigen::Vector2d size = ground_max - ground_min;
  const int count = static_cast<int>(0.0012 * plan.trees * std::max(plan.tree_density, 1.0) * size.x() * size.y());
  for (int i = 0; i < count; ++i) {
    Tree tree;
    const double tree_y = random.UniformDouble() * size.y(), tree_x = random.UniformDouble() * size.x();
    tree.position = ground_min + Eigen::Vector2d(tree_x, tree_y);
    tree.height_m = random.Uniform(5.0, 11.0);
    tree.crown_radius_m = random.Uniform(0.28, 0.4) * tree.height_m;
    tree.conifer = random.UniformDouble() < 0.3;
    tree.seed = random.NextU32();
    const GroundSample ground = Sample(static_cast<float>(tree.position.x()), static_cast<float>(tree.position.y()));
    // Groves: more trees where a noise of long wavelength is high.
    const float grove = ValueNoise(static_cast<float>(tree.position.x()) / 35.0F, static_cast<float>(tree.position.y()) / 35.0F, 77U);
    if (ground.kind == GroundKind::kField && grove > 0.1F) contents_.trees.push_back(tree);
  }
}

GroundSample CityLayout::Sample(float east, float north) const {
  const Eigen::Vector2f city = turn_.TurnedBack({static_cast<double>(east), static_cast<double>(north)}).cast<float>();
  const float u = (city.x() - phase_.x()) / pitch_;
  const float v = (city.y() - phase_.y()) / pitch_;
  const int near_x = std::clamp(FloorInt(u + 0.5F), first_x_, last_x_);
  const int near_y = std::clamp(FloorInt(v + 0.5F), first_y_, last_y_);
  const float dx = (u - static_cast<float>(near_x)) * pitch_;
  const float dy = (v - static_cast<float>(near_y)) * pitch_;
  const float ax = std::abs(dx);
  const float ay = std::abs(dy);
  GroundSample sample;
  sample.city = city;
  if (ax < kRoadHalfWidth || ay < kRoadHalfWidth) {
    sample.kind = GroundKind::kRoad;
    sample.crossing = ax < kRoadHalfWidth && ay < kRoadHalfWidth;
    const bool north_south = ax <= ay;
    sample.across = north_south ? dx : dy;
    sample.along = north_south ? city.y() : city.x();
    sample.to_crossing = north_south ? ay : ax;
    sample.street = north_south ? near_x * 2 : near_y * 2 + 1;
    return sample;
  }
  const int i = FloorInt(u) - first_x_;
  const int j = FloorInt(v) - first_y_;
  const bool inside = i >= 0 && i < columns_ && j >= 0 && j < rows_;
  if (inside && (ax < kRoadHalfWidth + kPavementWidth || ay < kRoadHalfWidth + kPavementWidth)) {
    sample.kind = GroundKind::kPavement;
    return sample;
  }
  if (!inside) return sample;
  sample.cell = &cells_[static_cast<size_t>(j) * static_cast<size_t>(columns_) + static_cast<size_t>(i)];
  sample.kind = GroundKind::kCell;
  for (const PavedArea& pad : sample.cell->pads) {
    const Eigen::Vector2f local = pad.Local(city.x(), city.y());
    if (std::abs(local.x()) < pad.half.x() && std::abs(local.y()) < pad.half.y()) {
      sample.kind = GroundKind::kPad;
      sample.pad = &pad;
    }
  }
  return sample;
}

std::vector<CityLayout::Lane> CityLayout::LanesAcross(int axis, const Eigen::Vector2d& min, const Eigen::Vector2d& max) const {
  const double pitch = static_cast<double>(pitch_), phase = static_cast<double>(phase_[axis]);
  Eigen::Vector2d low = turn_.TurnedBack(min), high = low;
  for (const Eigen::Vector2d& corner : {max, Eigen::Vector2d(min.x(), max.y()), Eigen::Vector2d(max.x(), min.y())}) {
    low = low.cwiseMin(turn_.TurnedBack(corner));
    high = high.cwiseMax(turn_.TurnedBack(corner));
  }
  const Eigen::Vector2d along = turn_.TurnedDirection(axis == 1 ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY());
  std::vector<Lane> lanes;
  double longest = 0.0;
  const auto first = static_cast<int>(std::ceil((low[axis] - phase) / pitch));
  const auto last = static_cast<int>(std::floor((high[axis] - phase) / pitch));
  for (int street = first; street <= std::max(first, last); ++street) {
    Lane lane{phase + street * pitch, low[1 - axis], high[1 - axis]};
    const Eigen::Vector2d origin = turn_.Turned(axis == 1 ? Eigen::Vector2d(0.0, lane.line) : Eigen::Vector2d(lane.line, 0.0));
    for (int side = 0; side < 2; ++side) {
      if (along[side] == 0.0) continue;
      const double one = (min[side] - origin[side]) / along[side], other = (max[side] - origin[side]) / along[side];
      lane.from = std::max(lane.from, std::min(one, other));
      lane.to = std::min(lane.to, std::max(one, other));
    }
    lanes.push_back(lane);
    longest = std::max(longest, lane.to - lane.from);
  }
  // Not the streets that only cut a corner of the rectangle.
  std::erase_if(lanes, [&](const Lane& lane) { return lane.to - lane.from < 0.5 * longest; });
  return lanes;
}

std::vector<std::array<Eigen::Vector2d, 2>> CityLayout::StreetsAcross(const Eigen::Vector2d& min, const Eigen::Vector2d& max) const {
  std::vector<std::array<Eigen::Vector2d, 2>> streets;
  for (const int axis : {0, 1}) {
    for (const Lane& lane : LanesAcross(axis, min, max)) {
      if (lane.to <= lane.from) continue;
      const auto end = [&](double along) { return turn_.Turned(axis == 1 ? Eigen::Vector2d(along, lane.line) : Eigen::Vector2d(lane.line, along)); };
      streets.push_back({end(lane.from), end(lane.to)});
    }
  }
  return streets;
}

std::vector<MovingCar> CityLayout::MakeMovingCars(int count, const Eigen::Vector2d& min, const Eigen::Vector2d& max, base::Random& random) const {
  std::vector<MovingCar> cars;
  for (int k = 0; k < count; ++k) {
    MovingCar car;
    const bool along_x = k % 2 == 0;
    const std::vector<Lane> lanes = LanesAcross(along_x ? 1 : 0, min, max);
    const Lane& lane = lanes[random.Below(static_cast<uint32_t>(lanes.size()))];
    const bool forward = random.UniformDouble() < 0.5;
    constexpr double kLane = 1.1;
    const double side = (along_x == forward) ? -kLane : kLane;  // traffic keeps right
    const double sign = forward ? 1.0 : -1.0;
    const double from = forward ? lane.from : lane.to;
    car.direction = turn_.TurnedDirection(along_x ? Eigen::Vector2d(sign, 0.0) : Eigen::Vector2d(0.0, sign));
    car.start = turn_.Turned(along_x ? Eigen::Vector2d(from, lane.line + side) : Eigen::Vector2d(lane.line + side, from));
    car.lane_length_m = lane.to - lane.from;
    car.offset_m = random.UniformDouble() * car.lane_length_m;
    car.speed_mps = random.Uniform(5.0, 11.0);
    car.seed = random.NextU32();
    cars.push_back(car);
  }
  return cars;
}

}  // namespace skyquilt::simulate
