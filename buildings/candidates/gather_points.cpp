#include "buildings/candidates/gather_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "buildings/planes/plane_sums.h"

namespace skyquilt::buildings {
namespace {

constexpr float kSteep = 0.35F;  // |normal.z|
constexpr float kLevel = 0.7F;   // normal.z of ground
constexpr double kWallReach_m = 2.0;
constexpr double kRingFrom_m = 0.5, kRingTo_m = 3.0;
constexpr double kGround_m = 0.3;
constexpr double kStepReach_m = 1.0;  // from a wall to the roof above it
constexpr float kNoRoof = -std::numeric_limits<float>::infinity();

// Per cell, the highest roof within kStepReach_m. Pieces that are too small to be parts of a building, such as lift houses, do not count, so that
// their sides are no walls of it; the largest piece always does.
std::vector<float> WallTops(const RoofArea& area, std::span<const PlanePiece> pieces) {
  double largest_m2 = 0.0;
  for (size_t cell = 0; cell < area.piece.size(); ++cell) {
    if (area.mask.value[cell] != 0 && area.piece[cell] >= 0)
      largest_m2 = std::max(largest_m2, pieces[static_cast<size_t>(area.piece[cell])].plane.area_m2);
  }
  std::vector<float> own(area.piece.size(), kNoRoof), tops(area.piece.size(), kNoRoof);
  for (size_t cell = 0; cell < own.size(); ++cell) {
    if (area.mask.value[cell] == 0 || area.piece[cell] < 0) continue;
    if (pieces[static_cast<size_t>(area.piece[cell])].plane.area_m2 >= std::min(kMinPart_m2, largest_m2)) own[cell] = area.roof_z[cell];
  }
  const auto reach = static_cast<int>(std::ceil(kStepReach_m / area.cell_m));
  for (int row = 0; row < area.mask.rows; ++row) {
    for (int column = 0; column < area.mask.columns; ++column) {
      float& top = tops[area.mask.Index(column, row)];
      for (int r = std::max(row - reach, 0); r <= std::min(row + reach, area.mask.rows - 1); ++r) {
        for (int c = std::max(column - reach, 0); c <= std::min(column + reach, area.mask.columns - 1); ++c) {
          if (std::hypot(c - column, r - row) <= reach) top = std::max(top, own[area.mask.Index(c, r)]);
        }
      }
    }
  }
  return tops;
}

// The piece's points on this roof, and the plane through them.
RoofPlane CutPlane(const RoofPlane& plane, const std::vector<uint32_t>& roof, const PointCloud& cloud) {
  RoofPlane cut = plane;
  cut.points.clear();
  std::set_intersection(plane.points.begin(), plane.points.end(), roof.begin(), roof.end(), std::back_inserter(cut.points));
  cut.area_m2 = static_cast<double>(cut.points.size()) * cloud.spacing_m * cloud.spacing_m;
  if (cut.points.size() < 3 || cut.points.size() == plane.points.size()) return cut;
  PlaneSums sums;
  for (const uint32_t i : cut.points) sums.Add(cloud.points[i].position);
  const FittedPlane fitted = sums.Fit(plane.normal);
  cut.middle = cloud.middle + fitted.middle;
  cut.normal = fitted.normal;
  cut.rms_m = fitted.rms_m;
  return cut;
}

std::vector<RoofPlane> CutPlanes(const RoofArea& area, std::span<const PlanePiece> pieces, const std::vector<uint32_t>& roof,
                                 const PointCloud& cloud) {
  std::vector<int32_t> here;
  for (size_t cell = 0; cell < area.piece.size(); ++cell) {
    if (area.mask.value[cell] != 0 && area.piece[cell] >= 0) here.push_back(area.piece[cell]);
  }
  std::sort(here.begin(), here.end());
  here.erase(std::unique(here.begin(), here.end()), here.end());
  std::vector<RoofPlane> planes;
  constexpr double kLeastPlane_m2 = 1.0;  // of what another building left of it
  for (const int32_t p : here) {
    RoofPlane cut = CutPlane(pieces[static_cast<size_t>(p)].plane, roof, cloud);
    if (cut.area_m2 >= kLeastPlane_m2 && cut.points.size() >= 3) planes.push_back(std::move(cut));
  }
  std::sort(planes.begin(), planes.end(), [](const RoofPlane& a, const RoofPlane& b) {
    return std::make_tuple(-a.area_m2, a.points.front()) < std::make_tuple(-b.area_m2, b.points.front());
  });
  return planes;
}

}  // namespace

Gathered GatherPoints(const RoofArea& area, std::span<const PlanePiece> pieces, const Surface& surface) {
  Gathered gathered;
  Candidate& candidate = gathered.candidate;
  const PointCloud& cloud = surface.cloud;
  const double tolerance_m = RoofTolerance(surface.gsd_m);
  const std::vector<int32_t> nearest = NearestCells(area.mask);
  const std::vector<float> wall_tops = WallTops(area, pieces);
  surface.plan.ForEachIn({area.origin, area.max()}, [&](uint32_t i) {
    const SurfacePoint& point = cloud.points[i];
    const Eigen::Vector3d at = cloud.At(i);
    const Eigen::Vector2d in_cells = (at.head<2>() - area.origin) / area.cell_m;
    const size_t cell =
        area.Index(std::min(static_cast<int>(in_cells.x()), area.columns - 1), std::min(static_cast<int>(in_cells.y()), area.rows - 1));
    if (nearest[cell] < 0 || point.filled != 0) return;
    const double distance_m = area.cell_m * CellDistance(area.mask, cell, nearest[cell]);
    if (std::abs(point.normal.z()) < kSteep) {
      const auto top = static_cast<double>(wall_tops[static_cast<size_t>(nearest[cell])]);
      if (distance_m > kWallReach_m || at.z() > top || ExcessGreen(point) > surface.options.max_green) return;
      candidate.wall.push_back(i);
      gathered.wall_distance_m.push_back(static_cast<float>(distance_m));
    } else if (distance_m == 0.0) {
      if (point.normal.z() > 0.0F && at.z() >= static_cast<double>(area.roof_z[cell]) - tolerance_m) candidate.roof.push_back(i);
    } else if (distance_m >= kRingFrom_m && distance_m <= kRingTo_m && point.normal.z() > kLevel) {
      if (std::abs(at.z() - surface.ground.At(at.head<2>())) <= kGround_m + surface.gsd_m) candidate.ground.push_back(i);
    }
  });
  std::sort(candidate.roof.begin(), candidate.roof.end());
  std::sort(candidate.ground.begin(), candidate.ground.end());
  candidate.planes = CutPlanes(area, pieces, candidate.roof, cloud);
  return gathered;
}

void ShareWalls(std::vector<Gathered>* all) {
  std::vector<std::tuple<uint32_t, float, size_t>> claims;  // point, distance, building
  for (size_t b = 0; b < all->size(); ++b) {
    const Gathered& gathered = (*all)[b];
    for (size_t k = 0; k < gathered.candidate.wall.size(); ++k) claims.emplace_back(gathered.candidate.wall[k], gathered.wall_distance_m[k], b);
  }
  std::sort(claims.begin(), claims.end());
  for (Gathered& gathered : *all) {
    gathered.candidate.wall.clear();
    gathered.wall_distance_m.clear();
  }
  for (size_t k = 0; k < claims.size(); ++k) {
    const auto& [point, distance_m, building] = claims[k];
    if (k > 0 && std::get<0>(claims[k - 1]) == point) continue;
    (*all)[building].candidate.wall.push_back(point);
    (*all)[building].wall_distance_m.push_back(distance_m);
  }
}

}  // namespace skyquilt::buildings
