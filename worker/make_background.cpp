#include "worker/make_background.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/order_statistics.h"
#include "core/survey/view_kind.h"

namespace skyquilt::worker {
namespace {

constexpr int kMostBackgroundCells = 384;  // along an axis
constexpr int kReach = 1;                  // cells on each side that colours are averaged over
constexpr double kSteepEnough = 0.35;      // rays closer to the horizon would spread one colour over hundreds of metres

constexpr size_t kMostSpacings = size_t{1} << 24U;

struct Splat {
  Eigen::Vector3d x;
  Eigen::Vector3f srgb;
  int column = 0;  // of its tile
  int photo = 0;
};

// Of the tiles of a training photo that show the ground, row by row.
std::vector<Splat> SplatsOf(const RaySource& source, const scene::HeightMap& points, int photo) {
  std::vector<Splat> splats;
  const std::vector<Eigen::Vector3f> colors = source.TileColors(photo);
  for (int row = 0; row < kTileRows; ++row) {
    for (int column = 0; column < kTileColumns; ++column) {
      const Eigen::Vector3f& srgb = colors[static_cast<size_t>(row) * kTileColumns + static_cast<size_t>(column)];
      Eigen::Vector3d origin, direction, x;
      source.RayThrough(photo, source.TileCentre({photo, static_cast<int16_t>(column), static_cast<int16_t>(row)}), &origin, &direction);
      if (direction.z() > -kSteepEnough || !points.Intersect(origin, direction, &x) || !srgb.allFinite()) continue;
      splats.push_back({x, srgb, column, photo});
    }
  }
  return splats;
}

// Splats of all photos, one after the other. When they are too many to be kept in memory, parts of them are made anew every time.
class SplatsOfPhotos {
 public:
  SplatsOfPhotos(const RaySource& source, const survey::Survey& survey, const scene::HeightMap& points, size_t photos_in_memory,
                 base::ThreadPool& threads)
      : source_(source),
        survey_(survey),
        points_(points),
        threads_(threads),
        keeps_(survey.photos.size() <= photos_in_memory),
        part_size_(keeps_ ? survey.photos.size() : std::max<size_t>(1, photos_in_memory / 8)) {}

  // Calls each(splat) in the order of photos and tiles.
  template <typename Each>
  void ForEach(const Each& each) {
    const size_t n = survey_.photos.size();
    for (size_t first = 0; first < n; first += part_size_) {
      if (!keeps_ || part_.empty()) Make(first, std::min(n, first + part_size_));
      for (const std::vector<Splat>& splats : part_) std::ranges::for_each(splats, each);
    }
  }

 private:
  void Make(size_t first, size_t end) {
    part_.assign(end - first, {});
    threads_.ParallelFor(static_cast<int64_t>(part_.size()), [&](int64_t task, int) {
      const size_t photo = first + static_cast<size_t>(task);
      if (!survey_.photos[photo].is_test) part_[static_cast<size_t>(task)] = SplatsOf(source_, points_, static_cast<int>(photo));
    });
  }

  const RaySource& source_;
  const survey::Survey& survey_;
  const scene::HeightMap& points_;
  base::ThreadPool& threads_;
  bool keeps_;
  size_t part_size_;
  std::vector<std::vector<Splat>> part_;
};

// The least of each cell and those beside it, 0 beyond the grid: takes back by how much splats were spread.
std::vector<uint8_t> LeastAround(const base::GridShape& shape, const std::vector<uint8_t>& values) {
  std::vector<uint8_t> least(values.size(), 0);
  for (int row = kReach; row < shape.rows - kReach; ++row) {
    for (int column = kReach; column < shape.columns - kReach; ++column) {
      uint8_t value = 255;
      for (int v = row - kReach; v <= row + kReach; ++v) {
        for (int u = column - kReach; u <= column + kReach; ++u) value = std::min(value, values[shape.Index(u, v)]);
      }
      least[shape.Index(column, row)] = value;
    }
  }
  return least;
}

// [elevation][azimuth][channel] of the sky in the training photos; empty when they show none.
std::vector<float> SkyOf(const RaySource& source, const survey::Survey& survey, const PointRanges& ranges) {
  using scene::Background;
  const base::GridShape shape{Background::kSkyColumns, Background::kSkyRows};
  std::vector<double> sum(3 * shape.size(), 0.0), count(shape.size(), 0.0);
  for (size_t photo = 0; photo < survey.photos.size(); ++photo) {
    if (survey.photos[photo].is_test) continue;
    const std::vector<Eigen::Vector3f> colors = source.TileColors(static_cast<int>(photo));
    for (const Tile& tile : TrainingTiles(survey, {static_cast<int>(photo)})) {
      const Eigen::Vector3f& srgb = colors[static_cast<size_t>(tile.row) * kTileColumns + static_cast<size_t>(tile.column)];
      if (!ranges.Of(tile).Sky() || !srgb.allFinite()) continue;
      Eigen::Vector3d origin, direction;
      source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
      const Eigen::Vector2d shares = scene::SkyShares(direction);
      const auto along = [](double share, int n) { return std::clamp(static_cast<int>(share * n), 0, n - 1); };
      const size_t cell = shape.Index(along(shares.x(), shape.columns), along(shares.y(), shape.rows));
      for (size_t c = 0; c < 3; ++c) sum[3 * cell + c] += static_cast<double>(srgb[static_cast<Eigen::Index>(c)]);
      count[cell] += 1.0;
    }
  }
  if (std::ranges::none_of(count, [](double n) { return n > 0.0; })) return {};
  for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0, count[i / 3]);
  scene::FillFromSurroundings(shape, 3, &sum, std::move(count));
  return {sum.begin(), sum.end()};
}

}  // namespace

scene::Background MakeBackground(const RaySource& source, const survey::Survey& survey, const scene::HeightMap& points, const PointRanges& ranges,
                                 uint64_t seed, base::ThreadPool& threads, size_t photos_in_memory) {
  scene::Background background;
  background.mean_srgb = source.MeanColor(seed);
  if (!ranges.Empty()) background.sky_srgb = SkyOf(source, survey, ranges);
  if (points.Empty()) return background;
  SplatsOfPhotos splats(source, survey, points, photos_in_memory, threads);
  std::vector<double> spacing;
  // Of very many neighbours every n-th tells the same median.
  const size_t every = survey.photos.size() * kTileRows * kTileColumns / kMostSpacings + 1;
  size_t neighbours = 0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInfinity), high = -low;
  std::optional<Eigen::Vector3d> before;
  splats.ForEach([&](const Splat& splat) {
    if (splat.column > 0 && before && neighbours++ % every == 0) spacing.push_back((splat.x - *before).head<2>().norm());
    low = low.cwiseMin(splat.x.head<2>());
    high = high.cwiseMax(splat.x.head<2>());
    before = splat.x;
  });
  if (spacing.empty()) return background;
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
  const double cell_m = std::max(base::UpperMedian(spacing), size.maxCoeff() / kMostBackgroundCells);
  if (!(cell_m > 0.0)) return background;
  const geo::PlaneGrid grid(low, cell_m, size);
  std::vector<double> sum(3 * grid.size(), 0.0), count(grid.size(), 0.0);
  std::vector<int> last_photo(grid.size(), -1);
  background.photos.assign(grid.size(), 0);
  const auto add = [&](const Splat& splat) {
    const int column = std::min(grid.columns - 1, static_cast<int>((splat.x.x() - low.x()) / cell_m));
    const int row = std::min(grid.rows - 1, static_cast<int>((splat.x.y() - low.y()) / cell_m));
    for (int v = std::max(0, row - kReach); v <= std::min(grid.rows - 1, row + kReach); ++v) {
      for (int u = std::max(0, column - kReach); u <= std::min(grid.columns - 1, column + kReach); ++u) {
        const size_t cell = grid.Index(u, v);
        for (size_t c = 0; c < 3; ++c) sum[3 * cell + c] += static_cast<double>(splat.srgb[static_cast<Eigen::Index>(c)]);
        count[cell] += 1.0;
        // Splats come photo by photo.
        if (std::exchange(last_photo[cell], splat.photo) != splat.photo && background.photos[cell] < 255) ++background.photos[cell];
      }
    }
  };
  splats.ForEach(add);
  // Photos that look level show the ground with few of their tiles, and what stands on it beyond.
  background.photos = survey::LooksLevel(survey) ? std::vector<uint8_t>() : LeastAround(grid, background.photos);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0, count[i / 3]);
  std::vector<double> heights;
  heights.reserve(grid.size());
  for (size_t cell = 0; cell < grid.size(); ++cell) heights.push_back(points.At(grid.CentreOf(cell).x(), grid.CentreOf(cell).y()));
  scene::FillFromSurroundings(grid, 3, &sum, std::move(count));
  background.surface = scene::HeightMap(grid, std::move(heights));
  background.rgb_srgb.assign(sum.begin(), sum.end());
  return background;
}

}  // namespace skyquilt::worker
