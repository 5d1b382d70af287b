#include "products/map_area.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

// Cells that the boundary's bounding box touches; empty (first = end) when it lies outside.
struct CellRange {
  int first_column = 0, end_column = 0, first_row = 0, end_row = 0;
  bool Empty() const { return first_column >= end_column || first_row >= end_row; }
};

CellRange CellsOf(const gis::MapGrid& grid, const gis::Boundary& boundary) {
  const auto clamp = [](double value, int most) { return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most))); };
  CellRange cells;
  cells.first_column = clamp(std::floor((boundary.min().x() - grid.left) / grid.resolution_m), grid.width);
  cells.end_column = clamp(std::ceil((boundary.max().x() - grid.left) / grid.resolution_m), grid.width);
  cells.first_row = clamp(std::floor((grid.top - boundary.max().y()) / grid.resolution_m), grid.height);
  cells.end_row = clamp(std::ceil((grid.top - boundary.min().y()) / grid.resolution_m), grid.height);
  return cells;
}

}  // namespace

std::optional<gis::Boundary> BoundaryOf(const gis::MapGrid& grid, const ProductOptions& options) {
  if (options.boundary.empty()) return std::nullopt;
  gis::Boundary boundary = gis::Boundary::Read(options.boundary, grid.georeferenced, grid.zone);
  if (CellsOf(grid, boundary).Empty()) {
    throw base::UsageError("the boundary " + options.boundary +
                           " (products.boundary) does not meet the survey. Give a polygon that does, with the right "
                           "coordinate system, or none");
  }
  return boundary;
}

gis::MapGrid CropTo(const gis::MapGrid& grid, const gis::Boundary& boundary) {
  const CellRange cells = CellsOf(grid, boundary);
  SKYQUILT_CHECK(!cells.Empty(), "a boundary outside the grid");
  gis::MapGrid cropped = grid;
  cropped.left = grid.left + cells.first_column * grid.resolution_m;
  cropped.top = grid.top - cells.first_row * grid.resolution_m;
  cropped.width = cells.end_column - cells.first_column;
  cropped.height = cells.end_row - cells.first_row;
  return cropped;
}

}  // namespace skyquilt::products
