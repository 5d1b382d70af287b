#include "simulate/city_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

constexpr double kCurbToCentre = static_cast<double>(kRoadHalfWidth + kPavementWidth);

}  // namespace

CityLayout::CityLayout(const CityPlan& plan, const Eigen::Vector2d& ground_min, const Eigen::Vector2d& ground_max, uint32_t seed)
    : pitch_(static_cast<float>(plan.pitch_m)), phase_(plan.phase.cast<float>()) {
  first_x_ = static_cast<int>(std::ceil((plan.min.x() - plan.phase.x()) / plan.pitch_m)) - 1;
  last_x_ = static_cast<int>(std::floor((plan.max.x() - plan.phase.x()) / plan.pitch_m)) + 1;
  first_y_ = static_cast<int>(std::ceil((plan.min.y() - plan.phase.y()) / plan.pitch_m)) - 1;
  last_y_ = static_cast<int>(std::floor((plan.max.y() - plan.phase.y()) / plan.pitch_m)) + 1;
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
  base::Random random(seed, 1);
  ChooseKinds(plan, random);
  for (size_t i = 0; i < cells_.size(); ++i) {
    base::Random cell_random(seed, 100 + i);
    FurnishCell(plan, cells_[i], contents_, cell_random);
  }
  AddStreetLife(plan, random);
  AddFieldTrees(plan, ground_min, ground_max, random);
}

void CityLayout::ChooseKinds(const CityPlan& plan, base::Random& random) {
  // The middle of the city gets one cell of each rarer kind, so that they exist for every seed.
  std::vector<size_t> by_distance(cells_.size());
  for (size_t i = 0; i < by_distance.size(); ++i) by_distance[i] = i;
  const Eigen::Vector2d middle = 0.5 * (plan.min + plan.max);
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
  if (by_distance.size() < 9) return;
  const std::array<std::pair<double, CellKind>, 3> wanted = {
      {{plan.tower_share, CellKind::kTowers}, {plan.park_share, CellKind::kPark}, {plan.flats_share, CellKind::kFlats}}};
  const size_t first = 1 + random.Below(2);
  size_t place = first;
  for (const auto& [share, kind] : wanted) {
    if (share > 0.0) cells_[by_distance[place]].kind = kind;
    place += 2;
  }
  cells_[by_distance[0]].kind = CellKind::kHouses;
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
        if (pick < 0.13 * plan.trees) {
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
  const int count = static_cast<int>(0.0012 * plan.trees * size.x() * size.y());
  for (int i = 0; i < count; ++i) {
    Tree tree;
    tree.position = ground_min + Eigen::Vector2d(random.UniformDouble() * size.x(), random.UniformDouble() * size.y());
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
  const float u = (east - phase_.x()) / pitch_;
  const float v = (north - phase_.y()) / pitch_;
  const int near_x = std::clamp(FloorInt(u + 0.5F), first_x_, last_x_);
  const int near_y = std::clamp(FloorInt(v + 0.5F), first_y_, last_y_);
  const float dx = (u - static_cast<float>(near_x)) * pitch_;
  const float dy = (v - static_cast<float>(near_y)) * pitch_;
  const float ax = std::abs(dx);
  const float ay = std::abs(dy);
  GroundSample sample;
  if (ax < kRoadHalfWidth || ay < kRoadHalfWidth) {
    sample.kind = GroundKind::kRoad;
    sample.crossing = ax < kRoadHalfWidth && ay < kRoadHalfWidth;
    const bool north_south = ax <= ay;
    sample.across = north_south ? dx : dy;
    sample.along = north_south ? north : east;
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
    const Eigen::Vector2f local = pad.Local(east, north);
    if (std::abs(local.x()) < pad.half.x() && std::abs(local.y()) < pad.half.y()) {
      sample.kind = GroundKind::kPad;
      sample.pad = &pad;
    }
  }
  return sample;
}

std::vector<MovingCar> CityLayout::MakeMovingCars(int count, const Eigen::Vector2d& min, const Eigen::Vector2d& max, base::Random& random) const {
  std::vector<MovingCar> cars;
  for (int k = 0; k < count; ++k) {
    MovingCar car;
    const bool eastward = k % 2 == 0;
    const int axis = eastward ? 1 : 0;
    // The streets inside the rectangle; the nearest one when there is none.
    const auto first = static_cast<int>(std::ceil((min[axis] - static_cast<double>(phase_[axis])) / static_cast<double>(pitch_)));
    const auto last = static_cast<int>(std::floor((max[axis] - static_cast<double>(phase_[axis])) / static_cast<double>(pitch_)));
    const int street = first + static_cast<int>(random.Below(static_cast<uint32_t>(std::max(last - first + 1, 1))));
    const double line = static_cast<double>(phase_[axis]) + street * static_cast<double>(pitch_);
    const bool forward = random.UniformDouble() < 0.5;
    constexpr double kLane = 1.1;
    const double side = (eastward == forward) ? -kLane : kLane;  // traffic keeps right
    car.direction = eastward ? Eigen::Vector2d(forward ? 1.0 : -1.0, 0.0) : Eigen::Vector2d(0.0, forward ? 1.0 : -1.0);
    const double from = (forward ? min : max)[1 - axis];
    car.start = eastward ? Eigen::Vector2d(from, line + side) : Eigen::Vector2d(line + side, from);
    car.lane_length_m = (max - min)[1 - axis];
    car.offset_m = random.UniformDouble() * car.lane_length_m;
    car.speed_mps = random.Uniform(5.0, 11.0);
    car.seed = random.NextU32();
    cars.push_back(car);
  }
  return cars;
}

}  // namespace skyquilt::simulate
