#include "viewer/queries/volume_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {
namespace {

double Square(double x) {
  return x * x;
}

// Neighbours of a cell that have a height: to the right, above, and both.
struct Neighbours {
  double own, right, above, across;
};

class Neighbourhood {
 public:
  Neighbourhood(const PolygonCells& cells, const std::vector<double>& heights) : cells_(cells), heights_(heights) {}

  Neighbours Of(size_t index) const {
    const std::optional<size_t> right = cells_.Right(index), above = cells_.Above(index);
    std::optional<size_t> across;
    if (above) across = cells_.Right(*above);
    if (!across && right) across = cells_.Above(*right);
    return {heights_[index], Value(right), Value(above), Value(across)};
  }

 private:
  double Value(std::optional<size_t> index) const { return index ? heights_[*index] : std::numeric_limits<double>::quiet_NaN(); }
  const PolygonCells& cells_;
  const std::vector<double>& heights_;
};

// Area of the triangle over half a cell with these heights at the right angle and at the other two corners; NaN when one is missing.
double TriangleArea(double cell_m, double at_right_angle, double a, double b) {
  return 0.5 * cell_m * std::sqrt(Square(cell_m) + Square(a - at_right_angle) + Square(b - at_right_angle));
}

struct Areas {
  double surface = 0.0, plan = 0.0;
};

// Of the surface between four neighbouring cell centres: the mean of both ways to cut it in two triangles, or the one triangle that there is.
Areas SurfaceBetween(double cell_m, const Neighbours& at) {
  const double triangles[] = {TriangleArea(cell_m, at.own, at.right, at.above), TriangleArea(cell_m, at.across, at.above, at.right),
                              TriangleArea(cell_m, at.right, at.own, at.across), TriangleArea(cell_m, at.above, at.across, at.own)};
  double sum = 0.0;
  int count = 0;
  for (const double area : triangles) {
    if (!std::isfinite(area)) continue;
    sum += area;
    ++count;
  }
  if (count == 0) return {};
  const double share = count == 4 ? 1.0 : 0.5;  // of the square
  return {share * sum * 2.0 / count, share * Square(cell_m)};
}

}  // namespace

VolumeResult SumVolume(const std::vector<Eigen::Vector2d>& polygon, const PolygonCells& cells, const CellHeights& heights, double sigma_base_m) {
  const size_t n = cells.size();
  std::vector<double> above_base(n);
  double sum_up = 0.0, sum_down = 0.0, sum_squares = 0.0, sum_base = 0.0, sum_variances = 0.0;
  size_t filled = 0, with_spread = 0;
  for (size_t i = 0; i < n; ++i) {
    const double d = above_base[i] = heights.heights_m[i] - heights.base_m[i];
    if (!std::isfinite(d)) continue;
    ++filled;
    sum_up += std::max(0.0, d);
    sum_down += std::max(0.0, -d);
    sum_squares += d * d;
    sum_base += heights.base_m[i];
    if (!std::isfinite(heights.spreads_m[i])) continue;
    ++with_spread;
    sum_variances += Square(heights.spreads_m[i]);
  }
  if (n == 0) throw BadMessage("the outline is too narrow to measure a volume");
  if (filled == 0) throw BadMessage("there is no surface within the outline, or none in one of the two surveys");

  Areas areas;
  double sum_steps = 0.0;
  const Neighbourhood of_heights(cells, heights.heights_m), of_differences(cells, above_base);
  for (size_t i = 0; i < n; ++i) {
    const Areas part = SurfaceBetween(cells.cell_m(), of_heights.Of(i));
    areas.surface += part.surface;
    areas.plan += part.plan;
    const Neighbours at = of_differences.Of(i);
    for (const double step : {at.right - at.own, at.above - at.own}) sum_steps += std::isfinite(step) ? step * step : 0.0;
  }

  const auto count = static_cast<double>(filled);
  const double area = std::abs(SignedArea(polygon)), cell = cells.cell_m();
  VolumeResult result;
  result.cell_m = cell;
  result.cells = static_cast<int64_t>(n);
  result.filled = count / static_cast<double>(n);
  result.plan_area_m2 = area;
  // One cell alone has no slope.
  result.surface_area_m2 = areas.plan > 0.0 ? area * areas.surface / areas.plan : area;
  result.cut_m3 = area * sum_up / count;
  result.fill_m3 = area * sum_down / count;
  result.net_m3 = result.cut_m3 - result.fill_m3;
  result.base_mean_m = sum_base / count;

  const double mean = (sum_up - sum_down) / count;
  const double variance = std::max(0.0, sum_squares / count - mean * mean);
  const double mean_spread = with_spread > 0 ? sum_variances / static_cast<double>(with_spread) : std::numeric_limits<double>::quiet_NaN();
  const double independent = std::max(1.0, area * result.filled / Square(std::max(kAlike_m, cell)));
  const double depth = area * std::sqrt(mean_spread / independent);
  const double base = area * sigma_base_m;
  const double boundaries = Square(cell) * std::sqrt((Perimeter(polygon) / cell * variance + sum_steps) / 12.0);
  const double holes = area * (1.0 - result.filled) * std::sqrt(variance);
  result.sigma_m3 = std::sqrt(Square(depth) + Square(base) + Square(boundaries) + Square(holes));
  return result;
}

}  // namespace skyquilt::viewer
