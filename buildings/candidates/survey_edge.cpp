#include "buildings/candidates/survey_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::buildings {
namespace {

constexpr double kLeastEdgeCell_m = 0.5, kEdgeCellSpacings = 2.5;
constexpr double kMostEdgeCells = 16e6;
constexpr double kOpening_m = 1.5;  // narrower openings in the surface do not let the outside in
constexpr double kOutlinePiece_m = 0.25;

}  // namespace

SurveyEdge::SurveyEdge(const PointCloud& cloud) {
  if (cloud.points.empty()) return;
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    low = low.cwiseMin(cloud.At(i).head<2>());
    high = high.cwiseMax(cloud.At(i).head<2>());
  }
  const double cell_m = std::max({kLeastEdgeCell_m, kEdgeCellSpacings * cloud.spacing_m, std::sqrt((high - low).prod() / kMostEdgeCells)});
  const double gap_cells = kOpening_m / cell_m;
  const int margin = 2 + static_cast<int>(std::ceil(gap_cells));
  const auto cells = [&](double length) { return 1 + 2 * margin + static_cast<int>(length / cell_m); };
  grid_ = {low - Eigen::Vector2d::Constant(margin * cell_m), cell_m, cells(high.x() - low.x()), cells(high.y() - low.y())};
  CellMask seen(grid_);
  for (size_t i = 0; i < cloud.points.size(); ++i) seen.value[static_cast<size_t>(grid_.CellAt(cloud.At(i).head<2>()))] = 1;
  // The surface with its narrow gaps closed.
  const CellMask closed = Eroded(Dilated(seen, 0.5 * gap_cells), 0.5 * gap_cells);
  CellMask empty(grid_);
  for (size_t i = 0; i < empty.value.size(); ++i) empty.value[i] = closed.value[i] == 0 && seen.value[i] == 0 ? 1 : 0;
  outside_ = CellMask(grid_);
  const std::vector<std::vector<uint32_t>> parts = ConnectedParts(empty);
  for (const uint32_t cell : parts.front()) outside_.value[cell] = 1;  // the margin has the first cell
  nearest_ = NearestCells(outside_);
}

double SurveyEdge::DistanceTo(const Eigen::Vector2d& enu) const {
  const int64_t at = grid_.CellAt(enu);
  if (at < 0) return 0.0;
  const auto cell = static_cast<size_t>(at);
  return std::max(0.0, grid_.cell_m * (CellDistance(outside_, cell, nearest_[cell]) - 0.5));
}

double SurveyEdge::ShareOf(const Polygon& outline, double reach_m) const {
  double all = 0.0, near = 0.0;
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d &from = ring[i], along = ring[(i + 1) % ring.size()] - from;
      const int pieces = std::max(1, static_cast<int>(std::ceil(along.norm() / kOutlinePiece_m)));
      const double piece_m = along.norm() / pieces;
      for (int k = 0; k < pieces; ++k) {
        all += piece_m;
        if (DistanceTo(from + (k + 0.5) / pieces * along) <= reach_m) near += piece_m;
      }
    }
  };
  add(outline.outer);
  for (const std::vector<Eigen::Vector2d>& hole : outline.holes) add(hole);
  return all > 0.0 ? near / all : 0.0;
}

}  // namespace skyquilt::buildings
