#include "viewer/queries/polygon_cells.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::viewer {
namespace {

constexpr double kFewestCells = 400.0;
constexpr double kMaxRows = 100'000.0;  // of slanting slivers, which have many rows and few cells
constexpr double kCoarser = 1.2;

struct Bounds {
  Eigen::Vector2d low, high;
};

Bounds BoundsOf(const std::vector<Eigen::Vector2d>& polygon) {
  Bounds bounds{polygon.front(), polygon.front()};
  for (const Eigen::Vector2d& corner : polygon) {
    bounds.low = bounds.low.cwiseMin(corner);
    bounds.high = bounds.high.cwiseMax(corner);
  }
  return bounds;
}

}  // namespace

double SignedArea(const std::vector<Eigen::Vector2d>& polygon) {
  double doubled = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    // Seen from the first corner: coordinates may be large.
    const Eigen::Vector2d a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    doubled += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * doubled;
}

double Perimeter(const std::vector<Eigen::Vector2d>& polygon) {
  double length = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) length += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
  return length;
}

Eigen::Vector2d CentroidOf(const std::vector<Eigen::Vector2d>& polygon) {
  Eigen::Vector2d moment = Eigen::Vector2d::Zero();
  double doubled = 0.0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - polygon[0], b = polygon[(i + 1) % polygon.size()] - polygon[0];
    const double cross = a.x() * b.y() - a.y() * b.x();
    doubled += cross;
    moment += cross * (a + b) / 3.0;
  }
  return polygon[0] + moment / doubled;
}

PolygonCells::PolygonCells(const std::vector<Eigen::Vector2d>& polygon, double finest_m) {
  const double area = std::abs(SignedArea(polygon));
  const Bounds bounds = BoundsOf(polygon);
  const Eigen::Vector2d extent = bounds.high - bounds.low;
  cell_m_ = std::min(finest_m, std::sqrt(area / kFewestCells));
  cell_m_ = std::max({cell_m_, std::sqrt(area / static_cast<double>(kMaxPolygonCells)), extent.y() / kMaxRows});
  while (!Fill(polygon)) cell_m_ *= kCoarser;
}

bool PolygonCells::Fill(const std::vector<Eigen::Vector2d>& polygon) {
  const Bounds bounds = BoundsOf(polygon);
  const Eigen::Array2d extent = (bounds.high - bounds.low).array();
  // The grid has the box's middle, so that no side is preferred.
  const Eigen::Array2d counts = (extent / cell_m_).ceil().max(1.0);
  first_centre_ = bounds.low + (0.5 * (extent - (counts - 1.0) * cell_m_)).matrix();
  runs_.clear();
  size_ = 0;
  std::vector<double> crossings;
  for (int64_t row = 0; row < static_cast<int64_t>(counts.y()); ++row) {
    const double y = first_centre_.y() + static_cast<double>(row) * cell_m_;
    crossings.clear();
    for (size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
      // Half-open, so that a corner on the line counts once.
      if ((a.y() <= y) != (b.y() <= y)) crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
    std::sort(crossings.begin(), crossings.end());
    for (size_t i = 0; i + 1 < crossings.size(); i += 2) {
      const auto first = static_cast<int64_t>(std::ceil((crossings[i] - first_centre_.x()) / cell_m_));
      const auto end = static_cast<int64_t>(std::ceil((crossings[i + 1] - first_centre_.x()) / cell_m_));
      if (end <= first) continue;
      runs_.push_back({.row = row, .first_column = first, .columns = end - first, .first_index = size_});
      size_ += static_cast<size_t>(end - first);
      if (size_ > kMaxPolygonCells) return false;
    }
  }
  return true;
}

const PolygonCells::Run& PolygonCells::RunOf(size_t index) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), index, [](size_t wanted, const Run& run) { return wanted < run.first_index; });
  return *std::prev(after);
}

Eigen::Vector2d PolygonCells::Centre(size_t index) const {
  const Run& run = RunOf(index);
  const auto column = static_cast<double>(run.first_column) + static_cast<double>(index - run.first_index);
  return first_centre_ + cell_m_ * Eigen::Vector2d(column, static_cast<double>(run.row));
}

std::optional<size_t> PolygonCells::Right(size_t index) const {
  const Run& run = RunOf(index);
  if (index + 1 < run.first_index + static_cast<size_t>(run.columns)) return index + 1;
  return {};
}

std::optional<size_t> PolygonCells::Above(size_t index) const {
  const Run& run = RunOf(index);
  const int64_t column = run.first_column + static_cast<int64_t>(index - run.first_index);
  // The first run that ends behind this column in the next row or a later one.
  const auto at = std::partition_point(runs_.begin(), runs_.end(), [&](const Run& other) {
    return other.row < run.row + 1 || (other.row == run.row + 1 && other.first_column + other.columns <= column);
  });
  if (at == runs_.end() || at->row != run.row + 1 || at->first_column > column) return {};
  return at->first_index + static_cast<size_t>(column - at->first_column);
}

}  // namespace skyquilt::viewer
