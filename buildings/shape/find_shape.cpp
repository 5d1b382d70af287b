#include "buildings/shape/find_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "buildings/shape/axis_points.h"
#include "buildings/shape/cell_rectangles.h"
#include "buildings/shape/part_score.h"
#include "buildings/shape/part_search.h"
#include "buildings/shape/right_angle.h"
#include "buildings/shape/roof_edges.h"
#include "buildings/shape/roof_raster.h"
#include "buildings/shape/wall_cells.h"
#include "buildings/shape/wall_lines.h"

namespace skyquilt::buildings {
namespace {

constexpr size_t kFewestPoints = 20;
constexpr double kLeastRegion_m2 = 15.0;
constexpr double kLeastHalf_m = 0.5;

// The cells of one rectangle, whatever its sides.
WallCells OneCell(const Eigen::Vector2d& half) {
  WallCells cells;
  cells.line = {std::vector<double>{-half.x(), half.x()}, std::vector<double>{-half.y(), half.y()}};
  cells.inside = {1};
  return cells;
}

ShapeGuess LeastRectangle(const Candidate& candidate, const PointCloud& cloud, double ground_z, double gsd_m) {
  const Rectangle rectangle = LeastAreaRectangle(candidate.outline.outer);
  Shape axes;
  axes.origin = rectangle.centre;
  axes.yaw_rad = std::atan2(rectangle.axis.y(), rectangle.axis.x());
  if (axes.yaw_rad < 0.0) axes.yaw_rad += std::numbers::pi;  // the rectangle is the same after half a turn
  axes.ground_z = ground_z;
  const RoofRaster raster = MakeRoofRaster(InAxes(candidate, cloud, axes), gsd_m);
  const WallCells cells = OneCell(rectangle.half.cwiseMax(kLeastHalf_m));
  return {PartScorer(axes, cells, raster, gsd_m).Score({{0, 1, 0, 1}}).shape, false};
}

}  // namespace

std::optional<ShapeGuess> FindShape(const Candidate& candidate, const Direction& direction, const PointCloud& cloud, double ground_z, double gsd_m) {
  if (candidate.roof.size() < kFewestPoints || candidate.outline.outer.size() < 3 || !std::isfinite(ground_z)) return std::nullopt;
  if (!(direction.concentration >= kLeastConcentration)) return LeastRectangle(candidate, cloud, ground_z, gsd_m);
  Shape axes;
  axes.origin = Centroid(candidate.outline);
  axes.yaw_rad = direction.yaw_rad;
  axes.ground_z = ground_z;
  const AxisPoints points = InAxes(candidate, cloud, axes);
  const RoofRaster raster = MakeRoofRaster(points, gsd_m);
  const auto filled = std::count_if(raster.height.begin(), raster.height.end(), [](float z) { return std::isfinite(z); });
  if (filled < static_cast<std::ptrdiff_t>(kFewestPoints)) return std::nullopt;
  const std::array<EdgesAcross, 2> edges = FindRoofEdges(raster);
  const WallCells cells = CutCells(FindWallLines(points, raster, edges), points, raster, edges);
  PartScorer scorer(axes, cells, raster, gsd_m);
  return ShapeGuess{FindParts(cells, CandidateRectangles(cells, raster, edges, kLeastRegion_m2), &scorer).shape, true};
}

}  // namespace skyquilt::buildings
