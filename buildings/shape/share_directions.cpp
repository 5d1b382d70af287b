#include <algorithm>
#include <cmath>
#include <numeric>

#include "buildings/shape/find_shape.h"
#include "buildings/shape/right_angle.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

constexpr double kDeviations = 2.0;

// Buildings whose directions became one: their mean, weighted by precision.
struct Group {
  double yaw_rad = 0.0, precision = 0.0;
};

struct Neighbours {
  size_t a = 0, b = 0;
  double deviations = 0.0;
};

class Groups {
 public:
  explicit Groups(std::span<const Direction> directions) : parent_(directions.size()), group_(directions.size()) {
    std::iota(parent_.begin(), parent_.end(), size_t{0});
    for (size_t i = 0; i < directions.size(); ++i) group_[i] = {directions[i].yaw_rad, 1.0 / (directions[i].sigma_rad * directions[i].sigma_rad)};
  }
  size_t RootOf(size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  const Group& Of(size_t root) const { return group_[root]; }
  void JoinIfAlike(size_t a, size_t b) {
    a = RootOf(a);
    b = RootOf(b);
    if (a == b) return;
    const Group &x = group_[a], &y = group_[b];
    const double difference = RightAngleDifference(y.yaw_rad, x.yaw_rad);
    if (std::abs(difference) >= kDeviations * std::sqrt(1.0 / x.precision + 1.0 / y.precision)) return;
    const double precision = x.precision + y.precision;
    const Group both{InRightAngle(x.yaw_rad + difference * y.precision / precision), precision};
    parent_[b] = a;
    group_[a] = both;
  }

 private:
  std::vector<size_t> parent_;
  std::vector<Group> group_;
};

bool MayShare(const Direction& direction) {
  return direction.concentration >= kLeastConcentration && direction.sigma_rad > 0.0 && std::isfinite(direction.sigma_rad);
}

// All pairs within reach, the most alike first.
std::vector<Neighbours> PairsWithin(std::span<const Direction> directions, std::span<const Eigen::Vector2d> places, double reach_m) {
  std::vector<size_t> by_east;
  for (size_t i = 0; i < directions.size(); ++i) {
    if (MayShare(directions[i])) by_east.push_back(i);
  }
  std::stable_sort(by_east.begin(), by_east.end(), [&](size_t a, size_t b) { return places[a].x() < places[b].x(); });
  std::vector<Neighbours> pairs;
  for (size_t i = 0; i < by_east.size(); ++i) {
    base::ThrowIfCancelled();
    for (size_t k = i + 1; k < by_east.size() && places[by_east[k]].x() - places[by_east[i]].x() <= reach_m; ++k) {
      const size_t a = std::min(by_east[i], by_east[k]), b = std::max(by_east[i], by_east[k]);
      if ((places[a] - places[b]).norm() > reach_m) continue;
      const double sigma = std::hypot(directions[a].sigma_rad, directions[b].sigma_rad);
      const double deviations = std::abs(RightAngleDifference(directions[a].yaw_rad, directions[b].yaw_rad)) / sigma;
      if (deviations < kDeviations) pairs.push_back({a, b, deviations});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Neighbours& x, const Neighbours& y) {
    if (x.deviations != y.deviations) return x.deviations < y.deviations;
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  return pairs;
}

}  // namespace

std::vector<Direction> ShareDirections(std::span<const Direction> directions, std::span<const Eigen::Vector2d> places, double reach_m) {
  SKYQUILT_CHECK(directions.size() == places.size(), "one place per direction");
  std::vector<Direction> shared(directions.begin(), directions.end());
  if (!(reach_m > 0.0)) return shared;
  Groups groups(directions);
  for (const Neighbours& pair : PairsWithin(directions, places, reach_m)) groups.JoinIfAlike(pair.a, pair.b);
  for (size_t i = 0; i < shared.size(); ++i) {
    if (!MayShare(shared[i])) continue;
    const Group& group = groups.Of(groups.RootOf(i));
    shared[i].yaw_rad = group.yaw_rad;
    shared[i].sigma_rad = 1.0 / std::sqrt(group.precision);
  }
  return shared;
}

}  // namespace skyquilt::buildings
