#include <fmt/core.h>

#include <cmath>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "surface/fusion/bricks.h"
#include "surface/fusion/fuse.h"
#include "surface/fusion/fusion_lattice.h"

namespace skyquilt::surface {
namespace {

// Nodes take 3 KiB; lists of bricks, cells, vertices and triangles the rest. A town of flat roofs was measured to take 7 KiB; trees have more
// surface.
constexpr double kBytesPerBrick = 12.0 * 1024.0;
// Of the memory limit that one piece may use: the fields of the scene take half, and finished pieces are kept and simplified meanwhile.
constexpr double kShareOfMemory = 0.25;
constexpr size_t kMostSampledBricks = size_t{1} << 22U;
constexpr size_t kViewsPerBatch = 64;

// Rows from south to north, columns from west to east; multiples of tile_voxels.
using TileOfPlan = std::pair<int, int>;
using BytesOfTiles = std::map<TileOfPlan, double>;

// A sample of the marked bricks, so that counting those of a large survey takes little memory. It depends on the set of bricks only.
class BrickSample {
 public:
  void Add(const std::vector<uint64_t>& keys) {
    for (const uint64_t key : keys) {
      if ((base::MixBits(key) & mask_) == 0) added_.push_back(key);
    }
  }
  // To be called after some keys have been added.
  void Merge() {
    std::sort(added_.begin(), added_.end());
    added_.erase(std::unique(added_.begin(), added_.end()), added_.end());
    std::vector<uint64_t> all;
    all.reserve(keys_.size() + added_.size());
    std::set_union(keys_.begin(), keys_.end(), added_.begin(), added_.end(), std::back_inserter(all));
    keys_ = std::move(all);
    added_.clear();
    while (keys_.size() > kMostSampledBricks) {
      mask_ = 2 * mask_ + 1;
      std::erase_if(keys_, [this](uint64_t key) { return (base::MixBits(key) & mask_) != 0; });
    }
  }
  const std::vector<uint64_t>& keys() const { return keys_; }
  // How many bricks each of them stands for.
  double factor() const { return static_cast<double>(mask_ + 1); }

 private:
  uint64_t mask_ = 0;
  std::vector<uint64_t> keys_;
  std::vector<uint64_t> added_;
};

int TileOfNode(int node, int tile_voxels) {
  return node >= 0 ? node / tile_voxels : -((tile_voxels - 1 - node) / tile_voxels);
}

// Calls use(tile) for the tiles that a brick reaches into: one, unless the sides of tiles are not a multiple of those of bricks.
template <typename Use>
void ForTilesOfBrick(uint64_t key, const LatticeBox& whole, int tile_voxels, const Use& use) {
  const Eigen::Vector3i first = (kBrickSide * BrickOfKey(key)).cwiseMax(whole.min);
  const Eigen::Vector3i last = (kBrickSide * (BrickOfKey(key) + Eigen::Vector3i::Ones())).cwiseMin(whole.max) - Eigen::Vector3i::Ones();
  for (int row = TileOfNode(first.y(), tile_voxels); row <= TileOfNode(last.y(), tile_voxels); ++row) {
    for (int column = TileOfNode(first.x(), tile_voxels); column <= TileOfNode(last.x(), tile_voxels); ++column) use(TileOfPlan(row, column));
  }
}

std::vector<TileOfPlan> TilesOfBricks(const std::vector<uint64_t>& keys, const LatticeBox& whole, int tile_voxels) {
  std::vector<TileOfPlan> tiles;
  for (const uint64_t key : keys) {
    ForTilesOfBrick(key, whole, tile_voxels, [&](const TileOfPlan& tile) {
      if (tiles.empty() || tiles.back() != tile) tiles.push_back(tile);
    });
  }
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles;
}

// The memory that fusing each tile with surface takes, its halo included.
BytesOfTiles EstimateTiles(std::span<const DepthView> views, const LatticeBox& whole, const FuseOptions& options, base::ThreadPool& threads) {
  if (IsEmptyBox(whole)) return {};
  SKYQUILT_CHECK(options.voxel_m > 0.0 && options.truncation_voxels > 0.0 && options.tile_voxels > 0,
                 "voxels, truncation and tiles must be positive");
  if (!HasDistinctKeys(whole)) {
    throw base::UsageError(
        fmt::format("voxels of {:.3g} m are too small for a survey of this size: there would be {} x {} x {} of them. Choose larger ones "
                    "with surface.voxel_gsd",
                    options.voxel_m, whole.max.x() - whole.min.x(), whole.max.y() - whole.min.y(), whole.max.z() - whole.min.z()));
  }
  const LatticeBox range = BricksOfNodes(whole);
  const std::vector<ViewCamera> cameras = CamerasThatSee(views, ReachOfBricks(range, options.voxel_m));
  BytesOfTiles tiles;
  BrickSample sample;
  base::Progress progress("surface pieces", static_cast<double>(cameras.size()), "views");
  for (size_t begin = 0; begin < cameras.size(); begin += kViewsPerBatch) {
    const size_t n = std::min(kViewsPerBatch, cameras.size() - begin);
    std::vector<std::vector<uint64_t>> keys(n);
    std::vector<std::vector<TileOfPlan>> tiles_of_view(n);
    threads.ParallelFor(static_cast<int64_t>(n), [&](int64_t i, int) {
      base::ThrowIfCancelled();
      const auto view = static_cast<size_t>(i);
      keys[view] = MarkBricks(cameras[begin + view], range, options);
      tiles_of_view[view] = TilesOfBricks(keys[view], whole, options.tile_voxels);
    });
    for (size_t view = 0; view < n; ++view) {
      sample.Add(keys[view]);
      for (const TileOfPlan& tile : tiles_of_view[view]) tiles.emplace(tile, 0.0);
    }
    sample.Merge();
    progress.Advance(static_cast<double>(n));
  }
  progress.Finish();
  const double with_halo = 1.0 + 2.0 * kBrickSide / options.tile_voxels;
  const double bytes = kBytesPerBrick * sample.factor() * with_halo * with_halo;
  for (const uint64_t key : sample.keys()) ForTilesOfBrick(key, whole, options.tile_voxels, [&](const TileOfPlan& tile) { tiles[tile] += bytes; });
  return tiles;
}

double LargestOf(const BytesOfTiles& tiles) {
  double largest = 0.0;
  for (const auto& [tile, bytes] : tiles) largest = std::max(largest, bytes);
  return largest;
}

// A rectangle of tiles that is fused at once.
struct TileGroup {
  TileOfPlan low, high;  // both inside
  double bytes = 0.0;

  void Join(const TileGroup& other) {
    low = {std::min(low.first, other.low.first), std::min(low.second, other.low.second)};
    high = {std::max(high.first, other.high.first), std::max(high.second, other.high.second)};
    bytes += other.bytes;
  }
};

// Joins each group with those after it as long as they fit.
std::vector<TileGroup> JoinWhileFitting(const std::vector<TileGroup>& groups, double limit_bytes) {
  std::vector<TileGroup> joined;
  for (const TileGroup& group : groups) {
    if (!joined.empty() && joined.back().bytes + group.bytes <= limit_bytes) {
      joined.back().Join(group);
    } else {
      joined.push_back(group);
    }
  }
  return joined;
}

// Several whole rows where they fit, otherwise parts of one row. Such rectangles do not overlap.
std::vector<TileGroup> GroupTiles(const BytesOfTiles& tiles, double limit_bytes) {
  std::map<int, std::vector<TileGroup>> rows;
  for (const auto& [tile, bytes] : tiles) rows[tile.first].push_back({tile, tile, bytes});
  std::vector<TileGroup> groups;
  std::vector<TileGroup> whole_rows;  // neighbours that fit one by one
  const auto close = [&] {
    const std::vector<TileGroup> joined = JoinWhileFitting(whole_rows, limit_bytes);
    groups.insert(groups.end(), joined.begin(), joined.end());
    whole_rows.clear();
  };
  for (const auto& [row, of_row] : rows) {
    const std::vector<TileGroup> parts = JoinWhileFitting(of_row, limit_bytes);
    if (parts.size() == 1) {
      whole_rows.push_back(parts[0]);
      continue;
    }
    close();
    groups.insert(groups.end(), parts.begin(), parts.end());
  }
  close();
  return groups;
}

}  // namespace

std::vector<LatticeBox> PlanPieces(std::span<const DepthView> views, const LatticeBox& whole, const FuseOptions& options, double memory_bytes,
                                   base::ThreadPool& threads, const PieceWishes& wishes, double* needs_bytes) {
  const BytesOfTiles tiles = EstimateTiles(views, whole, options, threads);
  const double limit_bytes = kShareOfMemory * memory_bytes;
  const double largest_bytes = LargestOf(tiles);
  if (!tiles.empty() && !(largest_bytes <= limit_bytes)) {
    constexpr double kMegabyte = 1e6;
    throw TooLittleMemory(
        fmt::format("--memory: {:.0f} MB are too small to fuse the surface: a piece needs about {:.0f} MB. Give more memory, or choose "
                    "larger voxels with surface.voxel_gsd",
                    std::floor(memory_bytes / kMegabyte), std::ceil(largest_bytes / kShareOfMemory / kMegabyte)));
  }
  const double all_bytes = std::accumulate(tiles.begin(), tiles.end(), 0.0, [](double sum, const auto& tile) { return sum + tile.second; });
  const double wished_bytes =
      std::min(kShareOfMemory * wishes.memory_bytes, all_bytes / static_cast<double>(std::max<size_t>(wishes.least_pieces, 1)));
  const double piece_bytes = std::max(largest_bytes, std::min(limit_bytes, wished_bytes));
  std::vector<LatticeBox> pieces;
  if (needs_bytes != nullptr) *needs_bytes = 0.0;
  for (const TileGroup& group : GroupTiles(tiles, piece_bytes)) {
    if (needs_bytes != nullptr) *needs_bytes = std::max(*needs_bytes, group.bytes / kShareOfMemory);
    LatticeBox piece = whole;
    piece.min.x() = std::max(piece.min.x(), group.low.second * options.tile_voxels);
    piece.min.y() = std::max(piece.min.y(), group.low.first * options.tile_voxels);
    piece.max.x() = std::min(piece.max.x(), (group.high.second + 1) * options.tile_voxels);
    piece.max.y() = std::min(piece.max.y(), (group.high.first + 1) * options.tile_voxels);
    pieces.push_back(piece);
  }
  return pieces;
}

double LargestTileBytes(std::span<const DepthView> views, const LatticeBox& whole, const FuseOptions& options, base::ThreadPool& threads) {
  return LargestOf(EstimateTiles(views, whole, options, threads)) / kShareOfMemory;
}

}  // namespace skyquilt::surface
