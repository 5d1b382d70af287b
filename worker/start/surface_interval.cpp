#include "worker/start/surface_interval.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/progress.h"
#include "core/render/march.h"
#include "core/render/ray_engine.h"

namespace skyquilt::worker {

std::vector<SurfaceInterval> SurfaceIntervals(const RaySource& source, const survey::Survey& survey, render::TrainedField& context,
                                              base::ThreadPool& threads) {
  context.BuildNetworks();
  render::FieldSet set;
  set.context = &context;
  const render::EngineOptions options = render::EngineOptions::DepthsOnly(0.85);
  constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<SurfaceInterval> bands(survey.photos.size() * kTilesOfPhoto, {kUnknown, kUnknown, kUnknown});
  // Some photos at a time: the rays of thousands would need gigabytes.
  constexpr size_t kPart = 64, kManyPhotos = 1000;
  std::optional<base::Progress> progress;
  if (survey.photos.size() >= kManyPhotos) {
    progress.emplace("context: surface in the photos", static_cast<double>(survey.photos.size()), "photos");
  }
  std::vector<int> photos;
  std::vector<render::Ray> rays;
  std::vector<render::RayColor> seen;
  for (size_t next = 0; next < survey.photos.size();) {
    photos.clear();
    for (; next < survey.photos.size() && photos.size() < kPart; ++next) photos.push_back(static_cast<int>(next));
    const std::vector<Tile> tiles = TrainingTiles(survey, photos);
    rays.resize(tiles.size());
    threads.ParallelFor(static_cast<int64_t>(tiles.size() / kTilesOfPhoto), [&](int64_t photo, int) {
      for (size_t i = static_cast<size_t>(photo) * kTilesOfPhoto; i < (static_cast<size_t>(photo) + 1) * kTilesOfPhoto; ++i) {
        source.RayThrough(tiles[i].photo, source.TileCentre(tiles[i]), &rays[i].origin_enu, &rays[i].direction_enu);
      }
    });
    seen.assign(rays.size(), {});
    render::RenderRays(set, rays, seen, options, threads);
    for (size_t i = 0; i < tiles.size(); ++i) {
      const Tile& tile = tiles[i];
      bands[BandIndex(tile.photo, tile.row, tile.column)] = {seen[i].depth_front, seen[i].depth_median, seen[i].depth_back};
    }
    if (progress) progress->Update(static_cast<double>(next));
  }
  return bands;
}

namespace {

enum class Use : uint8_t { kNone, kInside, kEmpty };

// What the surface that a tile shows says about the tile and its neighbours.
struct Sight {
  bool known = false, inside = false, behind = false;
};

// Decides about the tiles of one photo; every sight is computed once, though nine tiles ask for it.
class TileUse {
 public:
  TileUse(const render::TrainedField& target, const LoadedContext* context, const PointRanges& ranges, const RaySource& source, int photo)
      : target_(target), context_(context), ranges_(ranges), source_(source), photo_(photo) {}

  Use Of(const Tile& tile) {
    // The field is transparent before the sky.
    if (ranges_.OpenSky(tile)) return Interval(tile.row, tile.column, nullptr, nullptr).Empty() ? Use::kNone : Use::kEmpty;
    if (context_ == nullptr) return Interval(tile.row, tile.column, nullptr, nullptr).Empty() ? Use::kNone : Use::kInside;
    // A tile is inside when its own or a neighbouring tile's surface is inside the block's ground plan.
    bool any_inside = false, all_behind = true;
    for (int row = std::max(0, tile.row - 1); row <= std::min(kTileRows - 1, tile.row + 1); ++row) {
      for (int column = std::max(0, tile.column - 1); column <= std::min(kTileColumns - 1, tile.column + 1); ++column) {
        const Sight& sight = SightOf(row, column);
        any_inside = any_inside || sight.inside;
        all_behind = all_behind && sight.behind;
      }
    }
    return any_inside ? Use::kInside : all_behind ? Use::kEmpty : Use::kNone;
  }

 private:
  geo::Interval Interval(int row, int column, Eigen::Vector3d* origin, Eigen::Vector3d* direction) const {
    Eigen::Vector3d o, d;
    source_.RayThrough(photo_, source_.TileCentre({photo_, static_cast<int16_t>(column), static_cast<int16_t>(row)}), &o, &d);
    if (origin != nullptr) *origin = o;
    if (direction != nullptr) *direction = d;
    return render::FieldInterval(target_.map, o, d);
  }
  const Sight& SightOf(int row, int column) {
    Sight& sight = sights_[static_cast<size_t>(row) * kTileColumns + static_cast<size_t>(column)];
    if (sight.known) return sight;
    sight.known = true;
    Eigen::Vector3d o, d;
    const geo::Interval interval = Interval(row, column, &o, &d);
    const auto depth = static_cast<double>(context_->Band(photo_, row, column).median);
    const Eigen::Vector3d low = target_.map.min_enu(), high = target_.map.max_enu();
    if (!std::isfinite(depth)) {
      // The context shows no surface: inside when the ray leaves the box through its bottom.
      sight.inside = !interval.Empty() && (ranges_.Empty() ? o.z() + interval.t_far * d.z() <= low.z() + 1e-6
                                                           : !ranges_.Of({photo_, static_cast<int16_t>(column), static_cast<int16_t>(row)}).Sky());
      return sight;
    }
    const Eigen::Vector3d p = o + depth * d;
    sight.inside = p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y();
    sight.behind = !interval.Empty() && depth > interval.t_far + 2.0 * context_->field.step_m;
    return sight;
  }

  const render::TrainedField& target_;
  const LoadedContext* context_;
  const PointRanges& ranges_;
  const RaySource& source_;
  const int photo_;
  std::array<Sight, static_cast<size_t>(kTileRows)* kTileColumns> sights_ = {};
};

}  // namespace

void ChooseTiles(const survey::Survey& survey, const std::vector<Tile>& tiles, const render::TrainedField& target, const LoadedContext* context,
                 const PointRanges& ranges, double empty_ray_share, RaySource& source, base::ThreadPool& threads) {
  const LoadedContext* knows_depth = context != nullptr && context->HasSurfaceIntervals(survey) ? context : nullptr;
  std::vector<size_t> photo_begins;
  for (size_t i = 0; i < tiles.size(); ++i) {
    if (i == 0 || tiles[i].photo != tiles[i - 1].photo) photo_begins.push_back(i);
  }
  photo_begins.push_back(tiles.size());
  std::vector<Use> uses(tiles.size(), Use::kNone);
  threads.ParallelFor(static_cast<int64_t>(photo_begins.size()) - 1, [&](int64_t n, int) {
    const size_t begin = photo_begins[static_cast<size_t>(n)], end = photo_begins[static_cast<size_t>(n) + 1];
    TileUse use(target, knows_depth, ranges, source, tiles[begin].photo);
    for (size_t i = begin; i < end; ++i) uses[i] = use.Of(tiles[i]);
  });
  std::vector<Tile> inside, empty;
  for (size_t i = 0; i < tiles.size(); ++i) {
    if (uses[i] == Use::kInside) inside.push_back(tiles[i]);
    if (uses[i] == Use::kEmpty) empty.push_back(tiles[i]);
  }
  source.SetTiles(std::move(inside), std::move(empty), empty_ray_share);
}

}  // namespace skyquilt::worker
