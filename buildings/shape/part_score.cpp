#include "buildings/shape/part_score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <utility>

#include "buildings/shape/cell_pieces.h"
#include "buildings/shape/cell_rectangles.h"
#include "buildings/shape/joined_wings.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastPart_m2 = 15.0;  // on the roof of another
constexpr double kLeastWing_m2 = 8.0;   // beside the others
constexpr double kNarrowest_m = 1.5;
constexpr double kLeastOwnShare = 0.25;  // of its area that a part has to itself, so that its roof is fitted there only
constexpr double kRounded_gsd = 2.0;     // of roofs at their edges: small flat ones would look like hips
constexpr double kLeastFlatShare = 0.3;  // of points that must remain without them
constexpr size_t kMostRoofPoints = 800;
constexpr double kCorrelation_gsd = 3.0;  // of the errors of neighbouring points
constexpr double kLeastStorey_m = 1.0;    // that a part on the roof of another rises above it, on average
constexpr double kOverhang_m = 0.7;       // roofs may reach this far over the walls
constexpr double kOverhangCost = 0.2;     // of a covered cell there
constexpr double kAboveCost = 0.5;        // of one that is higher than its roof: parapets and boxes, not walls that are missing
constexpr double kLineCost_m2 = 1.0;
constexpr double kHeightCost_m2 = 0.5;
constexpr double kPartCost_m2 = 5.0;
constexpr double kUsualArea_m2 = 150.0;

// Covered cells with an uncovered one within reach along a row, a column or both.
std::vector<uint8_t> BesideEdge(const RoofRaster& raster, double reach_m) {
  const int reach = std::max(1, static_cast<int>(std::lround(reach_m / raster.cell_m)));
  std::vector<uint8_t> near(raster.covered.size(), 0);
  for (int row = 0; row < raster.rows; ++row) {
    for (int column = 0; column < raster.columns; ++column) {
      if (raster.covered[raster.Index(column, row)] != 0) continue;
      for (int r = std::max(0, row - reach); r <= std::min(raster.rows - 1, row + reach); ++r) {
        for (int c = std::max(0, column - reach); c <= std::min(raster.columns - 1, column + reach); ++c) near[raster.Index(c, r)] = 1;
      }
    }
  }
  return near;
}

}  // namespace

PartScorer::PartScorer(const Shape& axes, const WallCells& cells, const RoofRaster& raster, double gsd_m)
    : axes_(axes), cells_(cells), raster_(raster), gsd_m_(gsd_m), rounded_(BesideEdge(raster, kRounded_gsd * gsd_m)) {
  const auto covered = static_cast<double>(std::count(raster.covered.begin(), raster.covered.end(), uint8_t{1})) * raster.CellArea();
  parsimony_ = std::clamp(std::sqrt(covered / kUsualArea_m2), 0.5, 2.0);
}

ScoredShape PartScorer::Score(const std::vector<CellRectangle>& rectangles) {
  ScoredShape scored;
  scored.rectangles = rectangles;
  scored.cost = std::numeric_limits<double>::infinity();
  if (!IsAllowed(rectangles)) return scored;
  scored.shape = ShapeOf(rectangles);
  if (!StandOut(rectangles, scored.shape)) return scored;
  double unexplained = Unexplained(scored.shape);
  // Houses of a row may stand like wings without running into each other: the roofs tell.
  for (size_t i = 0; i < scored.shape.parts.size(); ++i) {
    const int main = MayJoin(scored.shape, scored.shape.parts[i]);
    if (main < 0) continue;
    Shape joined = scored.shape;
    joined.parts[i].joins = main;
    joined.parts[i].ridge_z = std::max(joined.parts[i].eave_z, std::min(joined.parts[i].ridge_z, joined.parts[static_cast<size_t>(main)].ridge_z));
    const double with = Unexplained(joined);
    if (!(with < unexplained)) continue;
    unexplained = with;
    scored.shape = std::move(joined);
  }
  int heights = 0;
  for (const Part& part : scored.shape.parts) heights += part.roof == RoofKind::kFlat ? 1 : 2;
  const double lines = static_cast<double>(scored.shape.u.size() + scored.shape.v.size());
  scored.cost = unexplained + parsimony_ * (kLineCost_m2 * lines + kHeightCost_m2 * heights + kPartCost_m2 * static_cast<double>(rectangles.size()));
  return scored;
}

bool PartScorer::IsAllowed(const std::vector<CellRectangle>& rectangles) const {
  const int columns = cells_.Columns(), rows = cells_.Rows();
  std::vector<uint8_t> count(static_cast<size_t>(columns) * static_cast<size_t>(rows), 0);
  const auto each_cell = [&](const CellRectangle& r, const auto& body) {
    for (int row = r.v0; row < r.v1; ++row) {
      for (int column = r.u0; column < r.u1; ++column) body(column, row);
    }
  };
  for (const CellRectangle& r : rectangles) {
    each_cell(r, [&](int c, int row) { ++count[cells_.Index(c, row)]; });
  }
  if (!IsOnePiece(count, columns, rows)) return false;
  if (rectangles.size() == 1) return true;
  for (const CellRectangle& r : rectangles) {
    if (std::count(rectangles.begin(), rectangles.end(), r) > 1) return false;
    const double width = std::min(cells_.Position(0, r.u1) - cells_.Position(0, r.u0), cells_.Position(1, r.v1) - cells_.Position(1, r.v0));
    double beside = 0.0;
    each_cell(r, [&](int c, int row) { beside += count[cells_.Index(c, row)] == 1 ? cells_.AreaOf(c, row) : 0.0; });
    if (width < kNarrowest_m || (beside < kLeastWing_m2 && (beside > 0.0 || cells_.AreaOf(r) < kLeastPart_m2))) return false;
  }
  return true;
}

bool PartScorer::StandOut(const std::vector<CellRectangle>& rectangles, const Shape& shape) {
  constexpr int kSteps = 6;
  for (size_t i = 0; i < rectangles.size(); ++i) {
    const Part& part = shape.parts[i];
    const Eigen::Vector2d low = shape.MinOf(part, false), size = shape.MaxOf(part, false) - low;
    double rise = 0.0, count = 0.0;
    for (size_t k = 0; k < rectangles.size(); ++k) {
      if (k == i || !IsWithin(rectangles[i], rectangles[k])) continue;
      for (int row = 0; row < kSteps; ++row) {
        for (int column = 0; column < kSteps; ++column) {
          const Eigen::Vector2d uv = low + size.cwiseProduct(Eigen::Vector2d(column + 0.5, row + 0.5) / kSteps);
          rise += std::max(0.0, RoofHeight(shape, part, uv) - RoofHeight(shape, shape.parts[k], uv));
          count += 1.0;
        }
      }
    }
    if (count > 0.0 && rise < kLeastStorey_m * count) return false;
  }
  return true;
}

RoofFit PartScorer::RoofOf(const std::vector<CellRectangle>& rectangles, size_t own) {
  const CellRectangle& r = rectangles[own];
  std::vector<CellRectangle> key;
  for (size_t i = 0; i < rectangles.size(); ++i) {
    CellRectangle both;
    // A part inside another stands on it and hides it; where parts cross, neither is known to be the higher one.
    if (i != own && Overlap(r, rectangles[i], &both) && !IsWithin(r, rectangles[i])) key.push_back(both);
  }
  std::sort(key.begin(), key.end());
  key.insert(key.begin(), r);
  if (const auto known = roofs_.find(key); known != roofs_.end()) return known->second;

  const Eigen::Vector2d low(cells_.Position(0, r.u0), cells_.Position(1, r.v0)), high(cells_.Position(0, r.u1), cells_.Position(1, r.v1));
  const RoofRaster::Range columns = raster_.Between(0, low.x(), high.x()), rows = raster_.Between(1, low.y(), high.y());
  std::vector<Eigen::Vector3d> all, alone, inner;
  for (int row = rows.first; row < rows.last; ++row) {
    for (int column = columns.first; column < columns.last; ++column) {
      const auto height = static_cast<double>(raster_.height[raster_.Index(column, row)]);
      if (!std::isfinite(height)) continue;
      const Eigen::Vector2d uv = raster_.Centre(column, row);
      all.emplace_back(uv.x(), uv.y(), height);
      const bool taken = std::any_of(key.begin() + 1, key.end(), [&](const CellRectangle& other) {
        return uv.x() > cells_.Position(0, other.u0) && uv.x() < cells_.Position(0, other.u1) && uv.y() > cells_.Position(1, other.v0) &&
               uv.y() < cells_.Position(1, other.v1);
      });
      if (taken) continue;
      alone.emplace_back(uv.x(), uv.y(), height);
      if (rounded_[raster_.Index(column, row)] == 0) inner.emplace_back(uv.x(), uv.y(), height);
    }
  }
  if (static_cast<double>(inner.size()) >= kLeastFlatShare * static_cast<double>(alone.size())) alone.swap(inner);
  std::vector<Eigen::Vector3d>& points = static_cast<double>(alone.size()) >= kLeastOwnShare * static_cast<double>(all.size()) ? alone : all;
  const double area = static_cast<double>(points.size()) * raster_.CellArea();
  if (points.size() > kMostRoofPoints) {
    std::vector<Eigen::Vector3d> fewer;
    for (size_t i = 0; i < kMostRoofPoints; ++i) fewer.push_back(points[i * points.size() / kMostRoofPoints]);
    points.swap(fewer);
  }
  RoofFit fit;
  fit.eave_z = fit.ridge_z = axes_.ground_z;
  if (points.size() >= 3) {
    const double length = kCorrelation_gsd * gsd_m_;
    fit =
        ChooseRoof(points, low, high, 2.0 * gsd_m_, std::clamp(area / (std::numbers::pi * length * length), 1.0, static_cast<double>(points.size())));
  }
  if (!std::isfinite(fit.eave_z) || !std::isfinite(fit.ridge_z)) fit.eave_z = fit.ridge_z = axes_.ground_z;
  roofs_.emplace(std::move(key), fit);
  return fit;
}

Shape PartScorer::ShapeOf(const std::vector<CellRectangle>& rectangles) {
  Shape shape = axes_;
  shape.u.clear();
  shape.v.clear();
  shape.parts.clear();
  std::set<int> used_u, used_v;
  for (const CellRectangle& r : rectangles) {
    used_u.insert({r.u0, r.u1});
    used_v.insert({r.v0, r.v1});
  }
  for (const int line : used_u) shape.u.push_back(cells_.Position(0, line));
  for (const int line : used_v) shape.v.push_back(cells_.Position(1, line));
  const auto number = [](const std::set<int>& used, int line) { return static_cast<int>(std::distance(used.begin(), used.find(line))); };
  for (size_t i = 0; i < rectangles.size(); ++i) {
    const CellRectangle& r = rectangles[i];
    const RoofFit fit = RoofOf(rectangles, i);
    Part part;
    part.u0 = number(used_u, r.u0);
    part.u1 = number(used_u, r.u1);
    part.v0 = number(used_v, r.v0);
    part.v1 = number(used_v, r.v1);
    part.roof = fit.roof;
    part.along_u = fit.along_u;
    part.eave_z = fit.eave_z;
    part.ridge_z = fit.ridge_z;
    shape.parts.push_back(part);
  }
  return shape;
}

double PartScorer::Unexplained(const Shape& shape) const {
  constexpr float kNothing = -std::numeric_limits<float>::infinity();
  std::vector<float> roof(raster_.height.size(), kNothing);
  std::vector<uint8_t> beside(raster_.height.size(), 0);
  for (const Part& part : shape.parts) {
    const Eigen::Vector2d low = shape.MinOf(part, true), high = shape.MaxOf(part, true);
    const auto each = [&](double margin, const auto& body) {
      const RoofRaster::Range columns = raster_.Between(0, low.x() - margin, high.x() + margin);
      const RoofRaster::Range rows = raster_.Between(1, low.y() - margin, high.y() + margin);
      for (int row = rows.first; row < rows.last; ++row) {
        for (int column = columns.first; column < columns.last; ++column) body(raster_.Index(column, row), column, row);
      }
    };
    each(kOverhang_m, [&](size_t cell, int, int) { beside[cell] = 1; });
    each(0.0, [&](size_t cell, int column, int row) {
      roof[cell] = std::max(roof[cell], static_cast<float>(RoofHeight(shape, part, raster_.Centre(column, row))));
    });
  }
  const double scale = 2.0 * gsd_m_;
  double cost = 0.0;
  for (size_t cell = 0; cell < roof.size(); ++cell) {
    const bool covered = raster_.covered[cell] != 0, inside = roof[cell] > kNothing;
    if (covered && inside) {
      const auto height = static_cast<double>(raster_.height[cell]);
      if (!std::isfinite(height)) continue;
      const double residual = (height - static_cast<double>(roof[cell])) / scale, square = residual * residual;
      cost += (residual > 2.0 ? kAboveCost : 1.0) * square / (1.0 + square);
    } else if (covered != inside) {
      cost += inside || beside[cell] == 0 ? 1.0 : kOverhangCost;
    }
  }
  return cost * raster_.CellArea();
}

}  // namespace skyquilt::buildings
