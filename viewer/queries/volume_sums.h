// From the heights of cells to a volume with its standard deviation.
//
// Estimator. A cell counts when its centre is inside the polygon. The mean height above the base over the cells with a surface, times the exact area
// of the polygon, is the volume: cells that the outline cuts and cells without a surface then cause no bias as long as they are like the others.
//
// Standard deviation of the net volume, from four independent parts:
//   depth     The cells' depth spreads, whose errors are alike within about a metre (kAlike_m), because photos are matched by patches and the field
//   is
//             smooth: area * sqrt(mean(spread^2) / n), n = measured area / kAlike_m^2, at least 1.
//   base      area * standard deviation of the mean height of the base plane, from the spreads at the corners.
//   cells     A boundary that runs through a cell is known to a fraction of it with variance 1/12. Boundaries are the outline, with the standard
//             deviation of the heights, and steps between neighbouring cells, with their height: cell^4 / 12 * (outline / cell * var(h) +
//             sum(step^2)).
//   holes     What lies in cells without a surface may differ from the mean as the other cells do, all alike: missing area * sd(h).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "viewer/protocol/replies.h"
#include "viewer/queries/polygon_cells.h"

namespace skyquilt::viewer {

constexpr double kAlike_m = 1.0;

struct CellHeights {
  // Per cell; NaN: no surface, or no base.
  std::vector<double> heights_m, base_m;
  std::vector<double> spreads_m;  // of height above base; NaN: unknown
};

// sigma_base_m: of the mean height of the base, 0 when it is part of the spreads. Throws BadMessage when no cell has a surface.
VolumeResult SumVolume(const std::vector<Eigen::Vector2d>& polygon, const PolygonCells& cells, const CellHeights& heights, double sigma_base_m);

}  // namespace skyquilt::viewer
