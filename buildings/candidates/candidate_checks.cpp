#include "buildings/candidates/candidate_checks.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "core/base/order_statistics.h"

namespace skyquilt::buildings {

namespace {

constexpr double kDropReach_m = 1.2;
// Found on simulated towns: houses drop on 0.5 to 1 of their border (less at the edge of the survey), ghosts on up to 0.3.
constexpr double kLeastDrop = 0.4;
constexpr double kDropWithoutWalls = 0.9;
constexpr double kLeastPlanar = 0.6;
constexpr double kSmall_m2 = 40.0, kMostHighAround = 0.2, kMainPlane = 0.5;
constexpr double kBandFrom_m = 0.4, kBandTo_m = 1.5;

}  // namespace

Standing MeasureStanding(const RoofArea& area, const TopRaster& top, const RoofLevels& levels, const GroundGrid& ground, double min_height_m) {
  const CellMask& mask = area.mask;
  const Eigen::Vector2d shift = (area.origin - top.origin) / area.cell_m;
  const auto left = static_cast<int>(std::lround(shift.x())), low = static_cast<int>(std::lround(shift.y()));
  const auto top_at = [&](int column, int row) { return static_cast<double>(top.top_z[top.Index(column + left, row + low)]); };
  const auto reach = static_cast<int>(std::floor(kDropReach_m / area.cell_m));
  double border = 0.0, dropping = 0.0, band = 0.0, high = 0.0, cells = 0.0, planar = 0.0;
  const std::vector<int32_t> nearest = NearestCells(mask);
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.columns; ++column) {
      const size_t cell = mask.Index(column, row);
      const Eigen::Vector2d at = area.Centre(column, row);
      if (mask.value[cell] == 0) {
        const double distance_m = area.cell_m * CellDistance(mask, cell, nearest[cell]);
        if (distance_m < kBandFrom_m || distance_m > kBandTo_m || std::isnan(top_at(column, row))) continue;
        band += 1.0;
        if (top_at(column, row) - ground.At(at) >= min_height_m) high += 1.0;
        continue;
      }
      cells += 1.0;
      if (levels.distance_m[top.Index(column + left, row + low)] <= 1.5F * static_cast<float>(area.cell_m)) planar += 1.0;
      bool on_border = false;
      for (const auto& [dx, dy] : {std::array{-1, 0}, std::array{1, 0}, std::array{0, -1}, std::array{0, 1}}) {
        on_border = on_border || !mask.Inside(column + dx, row + dy) || mask.value[mask.Index(column + dx, row + dy)] == 0;
      }
      if (!on_border) continue;
      const double roof = static_cast<double>(area.roof_z[cell]);
      const double height = roof - ground.At(at);
      double lowest = std::numeric_limits<double>::infinity();
      for (int r = std::max(row - reach, 0); r <= std::min(row + reach, mask.rows - 1); ++r) {
        for (int c = std::max(column - reach, 0); c <= std::min(column + reach, mask.columns - 1); ++c) {
          if (mask.value[mask.Index(c, r)] == 0 && !std::isnan(top_at(c, r)) && std::hypot(c - column, r - row) <= reach)
            lowest = std::min(lowest, top_at(c, r));
        }
      }
      border += 1.0;
      if (roof - lowest >= 0.5 * height) dropping += 1.0;
    }
  }
  Standing standing;
  standing.drop = border > 0.0 ? dropping / border : 0.0;
  standing.high_around = band > 0.0 ? high / band : 0.0;
  standing.planar = cells > 0.0 ? planar / cells : 0.0;
  return standing;
}

bool LooksLikeBuilding(const Standing& standing, double area_m2, double largest_m2, size_t n_wall) {
  if (standing.planar < kLeastPlanar || standing.drop < (n_wall == 0 ? kDropWithoutWalls : kLeastDrop)) return false;
  return !(area_m2 < kSmall_m2 && standing.high_around > kMostHighAround && largest_m2 < kMainPlane * area_m2);
}

namespace {

constexpr double kBorder_m = 0.5;

// Of the roof above the ground; not positive when one of them is unknown.
double RoofHeight(const Candidate& candidate, const PointCloud& cloud, const GroundGrid& ground) {
  std::vector<double> heights;
  for (const uint32_t i : candidate.roof) {
    const Eigen::Vector3d at = cloud.At(i);
    const double height = at.z() - ground.At(at.head<2>());
    if (std::isfinite(height)) heights.push_back(height);
  }
  return heights.empty() ? 0.0 : base::Median(std::move(heights));
}

}  // namespace

std::vector<MatchedPoints> CountMatched(std::span<const Candidate> candidates, std::span<const Eigen::Vector3d> points, const PointCloud& cloud,
                                        const GroundGrid& ground, base::ThreadPool& threads) {
  std::vector<MatchedPoints> counts(candidates.size());
  threads.ParallelFor(static_cast<int64_t>(candidates.size()), [&](int64_t task, int) {
    const auto c = static_cast<size_t>(task);
    const Polygon& outline = candidates[c].outline;
    const double roof_m = RoofHeight(candidates[c], cloud, ground);
    if (!(roof_m > 0.0)) return;
    Eigen::AlignedBox2d box;
    for (const Eigen::Vector2d& corner : outline.outer) box.extend(corner);
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector2d at = point.head<2>();
      if (!box.contains(at) || !Contains(outline, at) || DistanceToBorder(outline, at) <= kBorder_m) continue;
      const double height = point.z() - ground.At(at);
      if (std::isfinite(height)) ++(height < 0.5 * roof_m ? counts[c].low : counts[c].high);
    }
  });
  return counts;
}

namespace {

// Found on two simulated towns at this GSD whose colours were ignored. Crowns: mean 2.4 to 6 m2, two largest planes below 0.6 of small outlines, four
// below 0.78. Houses with bent roofs at the edge of a survey: mean from 4.2 m2; others from 7 m2; sheds are one or two planes.
constexpr double kFoundAt_m = 0.185;
constexpr double kLeastScale = 0.2, kMostScale = 1.5;
struct CrownLimits {
  double mean_m2, two, four;
};
constexpr CrownLimits kWithColours = {4.0, 0.5, 0.75}, kWithoutColours = {5.5, 0.6, 0.78};
constexpr double kOneMainPlane = 0.5;  // a roof with such a plane may be small
constexpr double kSmallOutline_m2 = 40.0;

}  // namespace

PlaneSizes SizesOf(std::span<const RoofPlane> planes, double outline_m2) {
  std::vector<double> areas;
  for (const RoofPlane& plane : planes) areas.push_back(plane.area_m2 * std::max(plane.normal.z(), 0.0));
  std::sort(areas.begin(), areas.end(), std::greater<>());
  double sum = 0.0, squares = 0.0;
  PlaneSizes sizes;
  sizes.outline_m2 = outline_m2;
  for (size_t i = 0; i < areas.size(); ++i) {
    sum += areas[i];
    squares += areas[i] * areas[i];
    if (i < 1) sizes.largest += areas[i] / outline_m2;
    if (i < 2) sizes.two += areas[i] / outline_m2;
    if (i < 4) sizes.four += areas[i] / outline_m2;
  }
  sizes.mean_m2 = sum > 0.0 ? squares / sum : 0.0;
  return sizes;
}

bool LooksLikeCrown(const PlaneSizes& sizes, double gsd_m, bool colours_tell) {
  if (sizes.largest >= kOneMainPlane) return false;
  const double scale = std::clamp(gsd_m / kFoundAt_m, kLeastScale, kMostScale);
  const CrownLimits& limits = colours_tell ? kWithColours : kWithoutColours;
  if (sizes.outline_m2 < scale * kSmallOutline_m2 && sizes.two < limits.two && sizes.four < limits.four) return true;
  return sizes.mean_m2 < scale * limits.mean_m2;
}

}  // namespace skyquilt::buildings
