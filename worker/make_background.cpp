#include "worker/make_background.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/base/order_statistics.h"

namespace skyquilt::worker {
namespace {

constexpr int kMostBackgroundCells = 384;  // along an axis
constexpr int kReach = 1;                  // cells on each side that colours are averaged over
constexpr double kSteepEnough = 0.35;      // rays closer to the horizon would spread one colour over hundreds of metres

struct Splat {
  Eigen::Vector3d x;
  Eigen::Vector3f srgb;
};

}  // namespace

scene::Background MakeBackground(const RaySource& source, const survey::Survey& survey, const scene::HeightMap& points, uint64_t seed) {
  scene::Background background;
  background.mean_srgb = source.MeanColor(seed);
  if (points.Empty()) return background;
  std::vector<int> photos;
  for (size_t i = 0; i < survey.photos.size(); ++i) photos.push_back(static_cast<int>(i));
  std::vector<Splat> splats;
  std::vector<double> spacing;
  std::vector<Eigen::Vector3f> colors;
  int colors_of = -1;
  for (const Tile& tile : TrainingTiles(survey, photos)) {
    if (tile.photo != colors_of) colors = source.TileColors(colors_of = tile.photo);
    Eigen::Vector3d origin, direction;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    Splat splat;
    const auto place = static_cast<size_t>(tile.row) * kTileColumns + static_cast<size_t>(tile.column);
    if (direction.z() > -kSteepEnough || !points.Intersect(origin, direction, &splat.x) || !colors[place].allFinite()) continue;
    splat.srgb = colors[place];
    if (tile.column > 0 && !splats.empty()) spacing.push_back((splat.x - splats.back().x).head<2>().norm());
    splats.push_back(splat);
  }
  if (spacing.empty()) return background;
  Eigen::Vector2d low = splats.front().x.head<2>(), high = low;
  for (const Splat& splat : splats) {
    low = low.cwiseMin(splat.x.head<2>());
    high = high.cwiseMax(splat.x.head<2>());
  }
  const Eigen::Vector2d size = (high - low).cwiseMax(1e-3);
  const double cell_m = std::max(base::UpperMedian(spacing), size.maxCoeff() / kMostBackgroundCells);
  if (!(cell_m > 0.0)) return background;
  const int columns = static_cast<int>(size.x() / cell_m) + 1, rows = static_cast<int>(size.y() / cell_m) + 1;
  const size_t cells = static_cast<size_t>(columns) * static_cast<size_t>(rows);
  std::vector<double> sum(3 * cells, 0.0), count(cells, 0.0);
  for (const Splat& splat : splats) {
    const int column = std::min(columns - 1, static_cast<int>((splat.x.x() - low.x()) / cell_m));
    const int row = std::min(rows - 1, static_cast<int>((splat.x.y() - low.y()) / cell_m));
    for (int v = std::max(0, row - kReach); v <= std::min(rows - 1, row + kReach); ++v) {
      for (int u = std::max(0, column - kReach); u <= std::min(columns - 1, column + kReach); ++u) {
        const size_t cell = static_cast<size_t>(v) * static_cast<size_t>(columns) + static_cast<size_t>(u);
        for (size_t c = 0; c < 3; ++c) sum[3 * cell + c] += static_cast<double>(splat.srgb[static_cast<Eigen::Index>(c)]);
        count[cell] += 1.0;
      }
    }
  }
  for (size_t i = 0; i < sum.size(); ++i) sum[i] /= std::max(1.0, count[i / 3]);
  std::vector<double> heights;
  heights.reserve(cells);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) heights.push_back(points.At(low.x() + (column + 0.5) * cell_m, low.y() + (row + 0.5) * cell_m));
  }
  scene::FillFromSurroundings(columns, rows, 3, &sum, std::move(count));
  background.surface = scene::HeightMap(low.x(), low.y(), cell_m, columns, rows, std::move(heights));
  background.rgb_srgb.assign(sum.begin(), sum.end());
  return background;
}

}  // namespace skyquilt::worker
