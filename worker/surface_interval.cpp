#include "worker/surface_interval.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/render/march.h"
#include "core/render/ray_engine.h"

namespace skyquilt::worker {

std::vector<SurfaceInterval> SurfaceIntervals(const RaySource& source, const survey::Survey& survey, render::TrainedField& context,
                                              base::ThreadPool& threads) {
  std::vector<int> photos(survey.photos.size());
  std::iota(photos.begin(), photos.end(), 0);
  const std::vector<Tile> tiles = TrainingTiles(survey, photos);
  std::vector<render::Ray> rays(tiles.size());
  for (size_t i = 0; i < tiles.size(); ++i) {
    source.RayThrough(tiles[i].photo, source.TileCentre(tiles[i]), &rays[i].origin_enu, &rays[i].direction_enu);
  }
  std::vector<render::RayColor> seen(rays.size());
  context.BuildNetworks();
  render::FieldSet set;
  set.context = &context;
  render::EngineOptions options;
  options.colour_threshold = 2.0F;  // depth only
  render::RenderRays(set, rays, seen, options, threads);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<SurfaceInterval> bands(survey.photos.size() * kTileRows * kTileColumns, {kUnknown, kUnknown, kUnknown});
  for (size_t i = 0; i < tiles.size(); ++i) {
    const Tile& tile = tiles[i];
    bands[BandIndex(tile.photo, tile.row, tile.column)] = {seen[i].depth_front, seen[i].depth_median, seen[i].depth_back};
  }
  return bands;
}

void ChooseTiles(const survey::Survey& survey, const std::vector<Tile>& tiles, const render::TrainedField& target, const LoadedContext* context,
                 double empty_ray_share, RaySource& source) {
  std::vector<Tile> inside, empty;
  const Eigen::Vector3d low = target.map.min_enu();
  const Eigen::Vector3d high = target.map.max_enu();
  const bool know_depth = context != nullptr && context->HasSurfaceIntervals(survey);
  for (const Tile& tile : tiles) {
    Eigen::Vector3d origin, direction;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!know_depth) {
      if (!render::FieldInterval(target.map, origin, direction).Empty()) inside.push_back(tile);
      continue;
    }
    // A tile is inside when its own or a neighbouring tile's surface is inside the block's ground plan.
    bool any_inside = false, all_behind = true;
    for (int row = std::max(0, tile.row - 1); row <= std::min(kTileRows - 1, tile.row + 1); ++row) {
      for (int column = std::max(0, tile.column - 1); column <= std::min(kTileColumns - 1, tile.column + 1); ++column) {
        const Tile neighbour{tile.photo, static_cast<int16_t>(column), static_cast<int16_t>(row)};
        Eigen::Vector3d o, d;
        source.RayThrough(neighbour.photo, source.TileCentre(neighbour), &o, &d);
        const auto depth = static_cast<double>(context->Band(tile.photo, row, column).median);
        const geo::Interval interval = render::FieldInterval(target.map, o, d);
        if (!std::isfinite(depth)) {
          // The context shows no surface: inside when the ray leaves the box through its bottom.
          const double out_z = o.z() + interval.t_far * d.z();
          if (!interval.Empty() && out_z <= low.z() + 1e-6) any_inside = true;
          all_behind = false;
          continue;
        }
        const Eigen::Vector3d p = o + depth * d;
        const bool above = p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y();
        any_inside = any_inside || above;
        all_behind = all_behind && !interval.Empty() && depth > interval.t_far + 2.0 * context->field.step_m;
      }
    }
    if (any_inside) {
      inside.push_back(tile);
    } else if (all_behind) {
      empty.push_back(tile);
    }
  }
  source.SetTiles(std::move(inside), std::move(empty), empty_ray_share);
}

}  // namespace skyquilt::worker
