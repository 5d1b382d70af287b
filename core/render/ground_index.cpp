#include "core/render/ground_index.h"

#include <cmath>
#include <utility>

namespace skyquilt::render {
namespace {

struct GroundPlan {
  Eigen::Vector2d low, high;
};

GroundPlan GroundPlanOf(const TrainedField& block) {
  const Eigen::Vector2d reach(block.blend_m, block.blend_m);
  return {block.map.min_enu().head<2>().cwiseMin(block.box.min_enu.head<2>() - reach),
          block.map.max_enu().head<2>().cwiseMax(block.box.max_enu.head<2>() + reach)};
}

// A component of zero stays where it is, however far the ray is followed.
double CoordinateAt(const Ray& ray, int axis, double t) {
  const double d = ray.direction_enu[axis];
  return d == 0.0 ? ray.origin_enu[axis] : ray.origin_enu[axis] + t * d;
}

}  // namespace

GroundIndex::GroundIndex(std::span<const TrainedField* const> blocks) {
  if (blocks.empty()) return;
  std::vector<GroundPlan> plans;
  for (const TrainedField* block : blocks) {
    plans.push_back(GroundPlanOf(*block));
    min_z_ = std::min({min_z_, block->map.min_enu().z(), block->box.min_enu.z()});
    max_z_ = std::max({max_z_, block->map.max_enu().z(), block->box.max_enu.z()});
  }
  low_ = plans.front().low;
  high_ = plans.front().high;
  for (const GroundPlan& plan : plans) {
    low_ = low_.cwiseMin(plan.low);
    high_ = high_.cwiseMax(plan.high);
  }
  const Eigen::Vector2d size = (high_ - low_).cwiseMax(1e-9);
  const auto n = static_cast<double>(blocks.size());
  shape_.columns = static_cast<int>(std::clamp(std::ceil(std::sqrt(n * size.x() / size.y())), 1.0, n));
  shape_.rows = static_cast<int>(std::ceil(n / shape_.columns));
  cell_m_ = size.cwiseQuotient(Eigen::Vector2d(shape_.columns, shape_.rows));
  // Counts first, then the blocks of each cell behind those of the cell before.
  first_.assign(shape_.size() + 1, 0);
  const auto for_cells = [&](const GroundPlan& plan, const auto& visit) {
    const int from[2] = {CellOf(plan.low.x(), 0), CellOf(plan.low.y(), 1)}, to[2] = {CellOf(plan.high.x(), 0), CellOf(plan.high.y(), 1)};
    for (int row = from[1]; row <= to[1]; ++row) {
      for (int column = from[0]; column <= to[0]; ++column) visit(shape_.Index(column, row));
    }
  };
  for (const GroundPlan& plan : plans) {
    for_cells(plan, [&](size_t cell) { ++first_[cell + 1]; });
  }
  for (size_t cell = 0; cell < shape_.size(); ++cell) first_[cell + 1] += first_[cell];
  blocks_.resize(static_cast<size_t>(first_.back()));
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (size_t k = 0; k < plans.size(); ++k) {
    for_cells(plans[k], [&](size_t cell) { blocks_[static_cast<size_t>(next[cell]++)] = static_cast<int>(k); });
  }
}

int GroundIndex::CellOf(double coordinate, int axis) const {
  const double cell = std::floor((coordinate - low_[axis]) / cell_m_[axis]);
  const int last = (axis == 0 ? shape_.columns : shape_.rows) - 1;
  if (!(cell > 0.0)) return 0;
  return cell < last ? static_cast<int>(cell) : last;
}

geo::Interval GroundIndex::HeightInterval(const Ray& ray, double min_z, double max_z) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double low = std::min(min_z, min_z_), high = std::max(max_z, max_z_);
  if (!(low <= high)) return {};
  return geo::RayBox(ray.origin_enu, ray.direction_enu, {-kInfinity, -kInfinity, low}, {kInfinity, kInfinity, high});
}

double GroundIndex::Slack(const Ray& ray) const {
  // Positions have errors of some 1e-16 of the largest coordinate.
  constexpr double kRelative = 1e-9;
  return kRelative * (1.0 + std::max({low_.cwiseAbs().maxCoeff(), high_.cwiseAbs().maxCoeff(), ray.origin_enu.head<2>().cwiseAbs().maxCoeff()}));
}

void GroundIndex::Find(const Ray& ray, const geo::Interval& within, std::vector<int>* found) const {
  found->clear();
  if (blocks_.empty() || within.Empty()) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const double slack = Slack(ray);
  const geo::Interval over = geo::RayBox(ray.origin_enu, ray.direction_enu, {low_.x() - slack, low_.y() - slack, -kInfinity},
                                         {high_.x() + slack, high_.y() + slack, kInfinity});
  const geo::Interval part = Intersection(over, within);
  if (over.Empty() || part.t_far < part.t_near) return;
  // Strips of cells across the axis along which the ray crosses more of them; in each strip the cells between the ray's two ends there.
  const Eigen::Vector2d cells_per_m = ray.direction_enu.head<2>().cwiseAbs().cwiseQuotient(cell_m_);
  const int along = cells_per_m.x() >= cells_per_m.y() ? 0 : 1, across = 1 - along;
  const double d = ray.direction_enu[along];
  const auto [begin, end] = std::minmax({CoordinateAt(ray, along, part.t_near), CoordinateAt(ray, along, part.t_far)});
  int cell[2];
  const int last = CellOf(end + slack, along);
  for (cell[along] = CellOf(begin - slack, along); cell[along] <= last; ++cell[along]) {
    double t0 = part.t_near, t1 = part.t_far;
    if (d != 0.0) {
      const double edge = low_[along] + cell[along] * cell_m_[along];
      const auto [enter, leave] =
          std::minmax({(edge - slack - ray.origin_enu[along]) / d, (edge + cell_m_[along] + slack - ray.origin_enu[along]) / d});
      t0 = std::clamp(enter, part.t_near, part.t_far);
      t1 = std::clamp(leave, part.t_near, part.t_far);
    }
    const auto [low, high] = std::minmax({CoordinateAt(ray, across, t0), CoordinateAt(ray, across, t1)});
    const int to = CellOf(high + slack, across);
    for (cell[across] = CellOf(low - slack, across); cell[across] <= to; ++cell[across]) {
      const size_t index = Index(cell);
      found->insert(found->end(), blocks_.begin() + first_[index], blocks_.begin() + first_[index + 1]);
    }
  }
  std::sort(found->begin(), found->end());
  found->erase(std::unique(found->begin(), found->end()), found->end());
}

}  // namespace skyquilt::render
