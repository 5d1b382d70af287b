#include "worker/start/starting_occupancy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/render/march.h"
#include "core/render/ray.h"
#include "worker/start/view_counter.h"

namespace skyquilt::worker {
namespace {

constexpr int kGroup = 4;
// Columns are wide enough to hold some points on average.
constexpr double kPointsPerColumn = 4.0;
// Size of the neighbourhood of a column, in columns on each side. The lowest point is taken from it because at the edge of a survey only roofs may
// have points. The highest point is taken from it for columns without points: foliage and smooth ground have few features to match, and density too
// high or too low there harms unseen views most.
constexpr int kGroundReach = 6;

// Occupies the cells that a tile's centre ray meets between two distances, metres; an end that is not finite is that of the field.
void OccupyAlong(const RaySource& source, const Tile& tile, double near, double far, render::TrainedField& target) {
  field::OccupancyGrid& grid = target.occupancy;
  Eigen::Vector3d origin, direction;
  source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
  const geo::Interval box = render::FieldInterval(target.map, origin, direction);
  const double begin = std::isfinite(near) ? std::max(box.t_near, near) : box.t_near, end = std::isfinite(far) ? std::min(box.t_far, far) : box.t_far;
  const double cell_m = static_cast<double>(grid.cell) / target.map.units_per_metre();
  for (double t = begin; t < end; t += 0.5 * cell_m) {
    const Eigen::Vector3f unit = target.map.UnitFromEnu(origin + t * direction);
    const auto index = static_cast<size_t>(grid.IndexAt(unit.x(), unit.y(), unit.z()));
    if (grid.tau[index] >= 0.0F) grid.occupied[index] = true;
  }
}

}  // namespace

void MarkUnseen(const RaySource& source, const survey::Survey& survey, const std::vector<int>& photos, const scene::HeightMap& surface,
                const PointRanges& ranges, int min_views, render::TrainedField& target, base::ThreadPool& threads) {
  field::OccupancyGrid& grid = target.occupancy;
  const int groups[3] = {(grid.size[0] + kGroup - 1) / kGroup, (grid.size[1] + kGroup - 1) / kGroup, (grid.size[2] + kGroup - 1) / kGroup};
  const auto centre_of = [&](int gx, int gy, int gz) {
    const Eigen::Vector3d unit = (Eigen::Vector3d(gx, gy, gz).array() + 0.5) * kGroup * static_cast<double>(grid.cell);
    return target.map.EnuFromUnit(unit.cwiseMin(target.map.extent()));
  };
  const auto radius_at = [&](const Eigen::Vector3d& x) {
    return 0.87 * kGroup * static_cast<double>(grid.cell) / (target.map.units_per_metre() * std::max(1e-6, target.map.LocalScale(x)));
  };
  const ViewCounter counter(survey, photos, [&source](int photo) -> const camera::Camera& { return source.CameraOf(photo); });
  // Columns of groups whose ground enough photos see.
  std::vector<uint8_t> enough_views(static_cast<size_t>(groups[0]) * static_cast<size_t>(groups[1]), 1);
  if (ranges.Empty() && !surface.Empty() && min_views > 1) {
    threads.ParallelFor(groups[1], [&](int64_t gy, int) {
      for (int gx = 0; gx < groups[0]; ++gx) {
        Eigen::Vector3d ground = centre_of(gx, static_cast<int>(gy), groups[2] / 2);
        ground.z() = surface.At(ground.x(), ground.y());
        enough_views[static_cast<size_t>(gy) * static_cast<size_t>(groups[0]) + static_cast<size_t>(gx)] =
            counter.Count(ground, 0.5 * radius_at(ground), min_views) >= min_views ? 1 : 0;
      }
    });
    if (std::ranges::count(enough_views, 1) == 0) std::ranges::fill(enough_views, uint8_t{1});
  }
  threads.ParallelFor(groups[2], [&](int64_t gz, int) {
    for (int gy = 0; gy < groups[1]; ++gy) {
      for (int gx = 0; gx < groups[0]; ++gx) {
        if (enough_views[static_cast<size_t>(gy) * static_cast<size_t>(groups[0]) + static_cast<size_t>(gx)] != 0) {
          const Eigen::Vector3d centre = centre_of(gx, gy, static_cast<int>(gz));
          const double radius = radius_at(centre);
          if (ranges.Empty()) {
            if (counter.Count(centre, radius, 1) > 0) continue;
          } else if (!ranges.InFreeSpace(centre, radius) &&
                     counter.Count(centre, radius, min_views, [&](int photo) { return ranges.MayShow(photo, centre, radius); }) >= min_views) {
            continue;
          }
        }
        for (int z = static_cast<int>(gz) * kGroup; z < std::min(grid.size[2], (static_cast<int>(gz) + 1) * kGroup); ++z) {
          for (int y = gy * kGroup; y < std::min(grid.size[1], (gy + 1) * kGroup); ++y) {
            for (int x = gx * kGroup; x < std::min(grid.size[0], (gx + 1) * kGroup); ++x) {
              grid.tau[static_cast<size_t>(grid.Index(x, y, z))] = -1.0F;
            }
          }
        }
      }
    }
  });
  // Not by several threads: cells share words.
  for (size_t i = 0; i < grid.tau.size(); ++i) {
    if (grid.tau[i] < 0.0F) grid.occupied[i] = false;
  }
}

void StartEverywhere(render::TrainedField& target) {
  for (float& tau : target.occupancy.tau) {
    if (tau >= 0.0F) tau = kStartTau;
  }
}

void StartFromPoints(const survey::Survey& survey, render::TrainedField& target) {
  const Eigen::Vector3d low = target.map.min_enu(), high = target.map.max_enu();
  std::vector<Eigen::Vector3d> points;
  for (const survey::SparsePoint& point : survey.points) {
    if ((point.x_in_enu.array() >= low.array()).all() && (point.x_in_enu.array() <= high.array()).all()) points.push_back(point.x_in_enu);
  }
  if (points.empty()) return;
  field::OccupancyGrid& grid = target.occupancy;
  const double cell_m = static_cast<double>(grid.cell) / target.map.units_per_metre();
  const Eigen::Vector2d size = (high - low).head<2>();
  const double column_m = std::max(2.0 * cell_m, std::sqrt(kPointsPerColumn * size.prod() / static_cast<double>(points.size())));
  const int columns = static_cast<int>(size.x() / column_m) + 1, rows = static_cast<int>(size.y() / column_m) + 1;
  struct Column {
    int count = 0;
    double lowest = std::numeric_limits<double>::infinity(), highest = -std::numeric_limits<double>::infinity(),
           highest_around = -std::numeric_limits<double>::infinity();
  };
  std::vector<Column> around(static_cast<size_t>(columns) * static_cast<size_t>(rows));
  for (const Eigen::Vector3d& point : points) {
    const int cx = static_cast<int>((point.x() - low.x()) / column_m), cy = static_cast<int>((point.y() - low.y()) / column_m);
    for (int y = std::max(0, cy - kGroundReach); y <= std::min(rows - 1, cy + kGroundReach); ++y) {
      for (int x = std::max(0, cx - kGroundReach); x <= std::min(columns - 1, cx + kGroundReach); ++x) {
        Column& column = around[static_cast<size_t>(y) * static_cast<size_t>(columns) + static_cast<size_t>(x)];
        column.lowest = std::min(column.lowest, point.z());
        column.highest_around = std::max(column.highest_around, point.z());
        if (std::abs(x - cx) > 1 || std::abs(y - cy) > 1) continue;
        if (x == cx && y == cy) ++column.count;
        column.highest = std::max(column.highest, point.z());
      }
    }
  }
  for (int z = 0; z < grid.size[2]; ++z) {
    for (int y = 0; y < grid.size[1]; ++y) {
      for (int x = 0; x < grid.size[0]; ++x) {
        const auto index = static_cast<size_t>(grid.Index(x, y, z));
        if (!grid.occupied[index]) continue;
        const Eigen::Vector3d p =
            target.map.EnuFromUnit((Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5) * static_cast<double>(grid.cell)).cwiseMin(target.map.extent()));
        if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
        const Column& column = around[static_cast<size_t>((p.y() - low.y()) / column_m) * static_cast<size_t>(columns) +
                                      static_cast<size_t>((p.x() - low.x()) / column_m)];
        const double highest = column.count == 0 ? column.highest_around : column.highest;
        if (!std::isfinite(highest)) continue;
        if (p.z() < column.lowest - cell_m || p.z() > highest + cell_m) grid.occupied[index] = false;
      }
    }
  }
  for (size_t i = 0; i < grid.tau.size(); ++i) {
    if (grid.tau[i] >= 0.0F) grid.tau[i] = grid.occupied[i] ? kStartTau : 0.0F;
  }
}

void StartFromRanges(const RaySource& source, const PointRanges& ranges, const std::vector<Tile>& tiles, render::TrainedField& target) {
  field::OccupancyGrid& grid = target.occupancy;
  std::fill(grid.occupied.begin(), grid.occupied.end(), false);
  for (const Tile& tile : tiles) {
    const PointRanges::Range& range = ranges.Of(tile);
    if (!range.Sky()) OccupyAlong(source, tile, static_cast<double>(range.near), static_cast<double>(range.far), target);
  }
  grid.Dilate(1);  // between tile centres
  for (size_t i = 0; i < grid.tau.size(); ++i) grid.tau[i] = grid.occupied[i] ? kStartTau : std::min(grid.tau[i], 0.0F);
}

void StartFromSurfaces(const RaySource& source, const PointRanges& ranges, const survey::Survey& survey, const std::vector<Tile>& tiles,
                       const LoadedContext& context, render::TrainedField& target) {
  if (!context.HasSurfaceIntervals(survey)) return;
  field::OccupancyGrid& grid = target.occupancy;
  const std::vector<bool> before = grid.occupied;
  std::fill(grid.occupied.begin(), grid.occupied.end(), false);
  // The context's surfaces are blurred by about one of its marching steps.
  const double pad_m = context.field.step_m;
  for (const Tile& tile : tiles) {
    if (ranges.OpenSky(tile)) continue;
    const SurfaceInterval& band = context.Band(tile.photo, tile.row, tile.column);
    OccupyAlong(source, tile, static_cast<double>(band.front) - pad_m, static_cast<double>(band.back) + pad_m, target);
  }
  if (grid.OccupiedShare() <= 0.0) {
    grid.occupied = before;
    return;
  }
  grid.Dilate(1);  // between tile centres
  for (const survey::SparsePoint& point : survey.points) {
    if ((point.x_in_enu.array() < target.map.min_enu().array()).any() || (point.x_in_enu.array() > target.map.max_enu().array()).any()) continue;
    const Eigen::Vector3f unit = target.map.UnitFromEnu(point.x_in_enu);
    const auto index = static_cast<size_t>(grid.IndexAt(unit.x(), unit.y(), unit.z()));
    if (grid.tau[index] >= 0.0F) grid.occupied[index] = true;
  }
  for (size_t i = 0; i < grid.tau.size(); ++i) grid.tau[i] = grid.occupied[i] ? kStartTau : std::min(grid.tau[i], 0.0F);
}

}  // namespace skyquilt::worker
