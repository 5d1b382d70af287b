#include "evaluate/ortho/compare_maps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/image/srgb.h"
#include "core/metrics/ssim.h"

namespace skyquilt::evaluate::ortho {
namespace {

constexpr int kSsimReach = 5;  // cells of SSIM's window on each side
constexpr int kHalo = std::max(kSsimReach, kSeamReach);
constexpr int kTileWidth = 400, kTileHeight = 300;  // cells; tiles are the pictures of the report, too
constexpr double kMostTruthPerTile = 800.0;         // cells of a much finer truth across a tile

std::vector<CellArea> TilesOf(const CellArea& area, double truth_per_cell) {
  const int width = std::clamp(static_cast<int>(kMostTruthPerTile / truth_per_cell), 32, kTileWidth), height = width * kTileHeight / kTileWidth;
  std::vector<CellArea> tiles;
  for (int y = area.top; y < area.bottom; y += height) {
    for (int x = area.left; x < area.right; x += width) {
      tiles.push_back({x, y, std::min(x + width, area.right), std::min(y + height, area.bottom)});
    }
  }
  return tiles;
}

// A tile of both maps with its halo; cells that only one of them knows are 0 in both.
struct TilePair {
  MapPart map, truth;
  image::Image8 both;
};

TilePair ReadPair(const OpenMaps& maps, const CellArea& tile, const Eigen::Vector2d& shift_m, int halo) {
  const int width = tile.right - tile.left + 2 * halo, height = tile.bottom - tile.top + 2 * halo;
  TilePair pair{ReadPart(maps.map, tile.left - halo, tile.top - halo, width, height),
                maps.truth.Read(tile.left - halo, tile.top - halo, width, height, shift_m), image::Image8(width, height, 1)};
  for (size_t i = 0; i < pair.both.data.size(); ++i) {
    pair.both.data[i] = pair.map.known.data[i] & pair.truth.known.data[i];
    if (pair.both.data[i] != 0) continue;
    for (image::ImageF* const rgb : {&pair.map.rgb, &pair.truth.rgb}) std::fill_n(&rgb->data[3 * i], 3, 0.0F);
  }
  return pair;
}

struct TileScore {
  skyquilt::metrics::SquaredError error;
  double ssim_sum = 0.0;
  int64_t ssim_cells = 0;
  SeamSums seams;
  std::vector<double> light_stops;  // per square (MapComparison::light_error_stops)
};

// Of the squares that lie inside a tile.
std::vector<double> LightOfSquares(const TilePair& pair) {
  std::vector<double> stops;
  for (int top = kHalo; top + kLightCells + kHalo <= pair.both.height; top += kLightCells) {
    for (int left = kHalo; left + kLightCells + kHalo <= pair.both.width; left += kLightCells) {
      double map = 0.0, truth = 0.0;
      bool known = true;
      for (int y = top; y < top + kLightCells && known; ++y) {
        for (int x = left; x < left + kLightCells && known; ++x) {
          known = *pair.both.At(x, y) != 0;
          for (int c = 0; c < 3; ++c) {
            map += static_cast<double>(image::LinearFromSrgb(pair.map.rgb.At(x, y)[c]));
            truth += static_cast<double>(image::LinearFromSrgb(pair.truth.rgb.At(x, y)[c]));
          }
        }
      }
      if (known && map > 0.0 && truth > 0.0) stops.push_back(std::log2(map / truth));
    }
  }
  return stops;
}

double SpreadAboutMedian(std::vector<double> stops) {
  if (stops.empty()) return kNotMeasured;
  const double middle = base::UpperMedian(stops);
  double squares = 0.0;
  for (const double value : stops) squares += (value - middle) * (value - middle);
  return std::sqrt(squares / static_cast<double>(stops.size()));
}

TileScore ScoreTile(const OpenMaps& maps, const CellArea& tile, const Eigen::Vector2d& shift_m, const HeightMap* heights) {
  TilePair pair = ReadPair(maps, tile, shift_m, kHalo);
  const int width = pair.both.width, height = pair.both.height;
  TileScore score;
  // SSIM leaves out its border, which is the halo.
  static_assert(kHalo == kSsimReach);
  image::ImageF ssim;
  if (width > 2 * kSsimReach && height > 2 * kSsimReach) skyquilt::metrics::Ssim(pair.map.rgb, pair.truth.rgb, &pair.both, &ssim);
  for (const float value : ssim.data) {
    if (!std::isfinite(value)) continue;
    score.ssim_sum += static_cast<double>(value);
    ++score.ssim_cells;
  }
  score.light_stops = LightOfSquares(pair);
  if (maps.sources) {
    gis::MapGrid grid = maps.map.grid();
    grid.left += (tile.left - kHalo) * grid.resolution_m;
    grid.top -= (tile.top - kHalo) * grid.resolution_m;
    const image::ImageF sources = maps.sources->Read(tile.left - kHalo, tile.top - kHalo, width, height);
    AddSeams({pair.map, pair.truth, sources, grid, kHalo}, heights, &score.seams);
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool inner = x >= kHalo && x < width - kHalo && y >= kHalo && y < height - kHalo;
      if (!inner) *pair.both.At(x, y) = 0;
    }
  }
  score.error = skyquilt::metrics::SumSquaredError(pair.map.rgb, pair.truth.rgb, &pair.both);
  return score;
}

image::Image8 PictureOfPart(const MapPart& part) {
  image::ImageF shown = part.rgb;
  for (size_t i = 0; i < part.known.data.size(); ++i) {
    if (part.known.data[i] == 0) std::fill_n(&shown.data[3 * i], 3, 1.0F);
  }
  return image::ToImage8(shown);
}

// Tiles that have data nearly everywhere, by how much they differ: the first of the list of tiles where several are alike.
std::vector<OrthoCrop> ChooseCrops(const std::vector<OpenMaps>& maps, const std::vector<CellArea>& tiles, const std::vector<TileScore>& scores,
                                   const Eigen::Vector2d& shift_m) {
  int64_t largest = 0;
  for (const TileScore& score : scores) largest = std::max(largest, score.error.n_values);
  std::vector<size_t> order;
  for (size_t i = 0; i < tiles.size(); ++i) {
    if (scores[i].error.n_values > 0 && 10 * scores[i].error.n_values >= 9 * largest) order.push_back(i);
  }
  const auto mean_error = [&](size_t i) { return scores[i].error.sum / static_cast<double>(scores[i].error.n_values); };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return mean_error(a) < mean_error(b); });
  std::vector<OrthoCrop> crops;
  const auto add = [&](size_t place, const char* what) {
    const size_t tile = order[place];
    const TilePair pair = ReadPair(maps.front(), tiles[tile], shift_m, 0);
    crops.push_back({PictureOfPart(pair.map), PictureOfPart(pair.truth), what, skyquilt::metrics::PsnrOf(scores[tile].error)});
  };
  const size_t n = order.size();
  if (n > 0) add(n - 1, "Where they differ most");
  if (n > 10) add(9 * n / 10, "Worse than nine tenths of the map");
  if (n > 2) add(n / 2, "As usual");
  return crops;
}

// Mean of the (2 radius + 1)^2 cells around each, of one channel; at the border of those that are there.
image::ImageF Blurred(const image::ImageF& image, int radius) {
  image::ImageF out = image;
  if (radius == 0) return out;
  for (int axis = 0; axis < 2; ++axis) {
    const image::ImageF from = out;
    const int lines = axis == 0 ? from.height : from.width, length = axis == 0 ? from.width : from.height;
    for (int line = 0; line < lines; ++line) {
      const auto at = [&](int i) { return axis == 0 ? from.At(i, line) : from.At(line, i); };
      double sum = 0.0;
      int low = 0, high = 0;  // cells [low, high) are in the sum
      for (int i = 0; i < length; ++i) {
        for (; high < std::min(length, i + radius + 1); ++high) sum += static_cast<double>(*at(high));
        for (; low < i - radius; ++low) sum -= static_cast<double>(*at(low));
        *(axis == 0 ? out.At(i, line) : out.At(line, i)) = static_cast<float>(sum / (high - low));
      }
    }
  }
  return out;
}

image::ImageF BrightnessOf(const MapPart& part) {
  image::ImageF grey(part.rgb.width, part.rgb.height, 1);
  for (size_t i = 0; i < grey.data.size(); ++i) grey.data[i] = (part.rgb.data[3 * i] + part.rgb.data[3 * i + 1] + part.rgb.data[3 * i + 2]) / 3.0F;
  return grey;
}

// Sums of a step of Gauss and Newton: of products of the truth's slopes, of slopes times differences, and of squared differences.
struct ShiftSums {
  double xx = 0.0, xy = 0.0, yy = 0.0, xd = 0.0, yd = 0.0, dd = 0.0;
};

ShiftSums SumsOf(const OpenMaps& maps, const CellArea& place, const Eigen::Vector2d& shift_m, int radius) {
  constexpr double kOutlier = 0.1;  // display values: no more of a car, a shadow or a wrong roof counts
  const TilePair pair = ReadPair(maps, place, shift_m, 0);
  const image::ImageF map = Blurred(BrightnessOf(pair.map), radius), truth = Blurred(BrightnessOf(pair.truth), radius);
  const auto difference = [&](int x, int y) { return static_cast<double>(*map.At(x, y)) - static_cast<double>(*truth.At(x, y)); };
  double mean = 0.0, n = 0.0;
  for (int y = 0; y < map.height; ++y) {
    for (int x = 0; x < map.width; ++x) {
      if (*pair.both.At(x, y) == 0) continue;
      mean += difference(x, y);
      n += 1.0;
    }
  }
  ShiftSums sums;
  if (n < 0.95 * static_cast<double>(map.data.size())) return sums;  // the border of the data is no texture
  mean /= n;
  for (int y = 1; y + 1 < map.height; ++y) {
    for (int x = 1; x + 1 < map.width; ++x) {
      const double east = 0.5 * static_cast<double>(*truth.At(x + 1, y) - *truth.At(x - 1, y));
      const double north = 0.5 * static_cast<double>(*truth.At(x, y - 1) - *truth.At(x, y + 1));
      const double d = std::clamp(difference(x, y) - mean, -kOutlier, kOutlier);
      sums.xx += east * east;
      sums.xy += east * north;
      sums.yy += north * north;
      sums.xd += east * d;
      sums.yd += north * d;
      sums.dd += d * d;
    }
  }
  return sums;
}

}  // namespace

OpenMaps::OpenMaps(const MapFiles& files) : map(files.map), truth(files.truth, map.grid()) {
  if (files.sources.empty()) return;
  sources.emplace(files.sources);
  const gis::MapGrid &a = map.grid(), &b = sources->grid();
  const bool same = a.width == b.width && a.height == b.height && std::abs(a.left - b.left) < 0.01 * a.resolution_m &&
                    std::abs(a.top - b.top) < 0.01 * a.resolution_m;
  if (!same) sources.reset();  // of another map
}

std::vector<OpenMaps> OpenForThreads(const MapFiles& files, const base::ThreadPool& threads) {
  std::vector<OpenMaps> maps;
  for (int i = 0; i < threads.size(); ++i) maps.emplace_back(files);
  return maps;
}

Eigen::Vector2d MeasureShift(const std::vector<OpenMaps>& maps, const CellArea& area, base::ThreadPool& threads) {
  constexpr int kPlaces = 4, kPlaceCells = 256;  // kPlaces x kPlaces
  constexpr int kFinest = 2;  // without any blur rounding to whole levels would favour shifts by half a cell, which smooth the truth
  constexpr std::array<int, 8> kRadii = {12, 12, 12, 4, 4, kFinest, kFinest, kFinest};
  constexpr double kMost = 30.0, kNothing = 0.05;  // cells
  const gis::MapGrid& grid = maps.front().map.grid();
  const int size = std::min(kPlaceCells, std::max(32, static_cast<int>(kMostTruthPerTile * grid.resolution_m / maps.front().truth.cell_m() / 4.0)));
  std::vector<CellArea> places;
  for (int j = 0; j < kPlaces; ++j) {
    for (int i = 0; i < kPlaces; ++i) {
      const int x = area.left + (2 * i + 1) * (area.right - area.left) / (2 * kPlaces) - size / 2;
      const int y = area.top + (2 * j + 1) * (area.bottom - area.top) / (2 * kPlaces) - size / 2;
      places.push_back({x, y, x + size, y + size});
    }
  }
  const auto sums_at = [&](const Eigen::Vector2d& shift_m, int radius) {
    std::vector<ShiftSums> each(places.size());
    threads.ParallelFor(static_cast<int64_t>(places.size()), [&](int64_t i, int thread) {
      base::ThrowIfCancelled();
      each[static_cast<size_t>(i)] = SumsOf(maps[static_cast<size_t>(thread)], places[static_cast<size_t>(i)], shift_m, radius);
    });
    ShiftSums all;
    for (const ShiftSums& one : each) {
      for (double ShiftSums::*const member : {&ShiftSums::xx, &ShiftSums::xy, &ShiftSums::yy, &ShiftSums::xd, &ShiftSums::yd, &ShiftSums::dd}) {
        all.*member += one.*member;
      }
    }
    return all;
  };
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();
  for (const int radius : kRadii) {
    const ShiftSums sums = sums_at(shift_m, radius);
    const double determinant = sums.xx * sums.yy - sums.xy * sums.xy;
    if (!(determinant > 1e-3 * sums.xx * sums.yy)) return Eigen::Vector2d::Zero();
    // The map shows at x what the truth has at x - shift.
    const Eigen::Vector2d step(sums.yy * sums.xd - sums.xy * sums.yd, sums.xx * sums.yd - sums.xy * sums.xd);
    shift_m -= grid.resolution_m / determinant * step;
    if (!(shift_m.norm() < kMost * grid.resolution_m)) return Eigen::Vector2d::Zero();
  }
  const bool better = sums_at(shift_m, kFinest).dd < sums_at(Eigen::Vector2d::Zero(), kFinest).dd;
  return better && shift_m.norm() > kNothing * grid.resolution_m ? shift_m : Eigen::Vector2d::Zero();
}

MapComparison CompareMaps(const std::vector<OpenMaps>& maps, const CellArea& area, const Eigen::Vector2d& shift_m, const HeightMap* heights,
                          base::ThreadPool& threads) {
  const std::vector<CellArea> tiles = TilesOf(area, maps.front().map.grid().resolution_m / maps.front().truth.cell_m());
  std::vector<TileScore> scores(tiles.size());
  threads.ParallelFor(static_cast<int64_t>(tiles.size()), [&](int64_t i, int thread) {
    base::ThrowIfCancelled();
    scores[static_cast<size_t>(i)] = ScoreTile(maps[static_cast<size_t>(thread)], tiles[static_cast<size_t>(i)], shift_m, heights);
  });
  MapComparison comparison;
  std::vector<double> light_stops;
  for (const TileScore& score : scores) {
    light_stops.insert(light_stops.end(), score.light_stops.begin(), score.light_stops.end());
    comparison.error += score.error;
    comparison.ssim_sum += score.ssim_sum;
    comparison.ssim_cells += score.ssim_cells;
    AddSeams(score.seams, &comparison.seams);
  }
  comparison.light_error_stops = SpreadAboutMedian(std::move(light_stops));
  comparison.crops = ChooseCrops(maps, tiles, scores, shift_m);
  return comparison;
}

}  // namespace skyquilt::evaluate::ortho
