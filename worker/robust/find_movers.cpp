#include "worker/robust/find_movers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "core/base/cancel.h"
#include "core/base/progress.h"

namespace skyquilt::worker {
namespace {

constexpr double kCell_m = 0.4;
constexpr int kFewestCellPixels = 2, kMostCellPixels = 8, kCellPixelsWithoutScale = 4;
constexpr size_t kPhotosAround = 24;  // that are asked about the places of a photo
constexpr size_t kMostOthers = 12;    // of a place
constexpr size_t kLeastOthers = 3;
constexpr double kMajority = 2.0 / 3.0;
constexpr double kLeastAxisCosine = 0.5;  // between the directions of photos that are compared
constexpr float kStrong = 0.10F;          // difference of display values, far beyond that of exposures and of a surface's gloss
constexpr float kWeak = 0.05F;
constexpr float kAgree = 0.25F;  // largest difference of others from their median colour
// Other distances that are tried, as parts of that of the surface: in front of it, and a little behind.
constexpr double kNearest = 0.7, kFarthest = 1.1;
constexpr int kDistances = 17;
constexpr double kExplains = 0.65;  // share of the photos that agree at such a distance
constexpr size_t kFewestCells = 3;
constexpr int kSmoothCells = 5;       // side of the squares in which smooth differences are measured
constexpr double kMostMovers = 0.03;  // share of a photo
constexpr double kMostLater = 0.5;

enum class Verdict : uint8_t { kUnknown, kAgrees, kWeak, kStrong };

size_t Majority(size_t n) {
  return std::max(kLeastOthers, static_cast<size_t>(std::ceil(kMajority * static_cast<double>(n))));
}

// A connected set of cells that differ.
struct Thing {
  std::vector<size_t> cells;
  double evidence = 0.0;  // sum of differences
};

// What is compared: whether the photo shows what others do not, or also whether others show what it does not.
enum class Side { kOwn, kBoth };

// Compares one photo with others.
class PhotoComparison {
 public:
  // others: the nearest first.
  PhotoComparison(const RaySource& source, const PhotoViews& views, size_t photo, std::vector<size_t> others, Side side, int cell_px)
      : source_(source), views_(views), picture_(views[photo].picture), photo_(photo), others_(std::move(others)), side_(side), cell_px_(cell_px) {
    const size_t n = picture_.cells.size();
    verdict_.resize(n, Verdict::kUnknown);
    difference_.resize(n, 0.0F);
    explained_.resize(n, -1);
    if (side == Side::kOwn) RemoveSmoothDifference();
    for (size_t cell = 0; cell < n; ++cell) Judge(cell);
  }

  size_t Compared() const {
    return static_cast<size_t>(std::ranges::count_if(verdict_, [](Verdict verdict) { return verdict != Verdict::kUnknown; }));
  }

  // With most evidence first.
  std::vector<Thing> Things() {
    std::vector<Thing> things;
    std::vector<char> taken(verdict_.size(), 0);
    for (size_t first = 0; first < verdict_.size(); ++first) {
      if (verdict_[first] != Verdict::kStrong || taken[first] != 0 || Explained(first)) continue;
      Thing thing;
      thing.cells.push_back(first);
      taken[first] = 1;
      for (size_t i = 0; i < thing.cells.size(); ++i) {
        thing.evidence += static_cast<double>(difference_[thing.cells[i]]);
        ForNeighbours(thing.cells[i], false, [&](size_t cell) {
          if (taken[cell] != 0 || verdict_[cell] < Verdict::kWeak || Explained(cell)) return;
          taken[cell] = 1;
          thing.cells.push_back(cell);
        });
      }
      if (IsLarge(thing)) things.push_back(std::move(thing));
    }
    std::ranges::stable_sort(things, [](const Thing& a, const Thing& b) { return a.evidence > b.evidence; });
    return things;
  }

  // Calls each(cell) for cells beside this one, corner to corner too with `diagonal`.
  template <typename Each>
  void ForNeighbours(size_t cell, bool diagonal, const Each& each) const {
    const int column = ColumnOf(cell), row = RowOf(cell);
    for (int v = std::max(0, row - 1); v <= std::min(picture_.rows - 1, row + 1); ++v) {
      for (int u = std::max(0, column - 1); u <= std::min(picture_.columns - 1, column + 1); ++u) {
        if ((u == column && v == row) || (!diagonal && u != column && v != row)) continue;
        each(static_cast<size_t>(v) * static_cast<size_t>(picture_.columns) + static_cast<size_t>(u));
      }
    }
  }

 private:
  int ColumnOf(size_t cell) const { return static_cast<int>(cell % static_cast<size_t>(picture_.columns)); }
  int RowOf(size_t cell) const { return static_cast<int>(cell / static_cast<size_t>(picture_.columns)); }

  // The ray through a cell's middle, up to the surface of the context.
  struct CellRay {
    Eigen::Vector3d origin, direction;
    double distance_m = 0.0;  // NaN: there is none
  };
  CellRay RayOf(size_t cell) const {
    const Eigen::Vector2d middle = (Eigen::Vector2d(ColumnOf(cell), RowOf(cell)) + Eigen::Vector2d::Constant(0.5)) * cell_px_;
    CellRay ray;
    source_.RayThrough(static_cast<int>(photo_), middle, &ray.origin, &ray.direction);
    ray.distance_m = views_.DistanceAt(photo_, middle);
    return ray;
  }

  // The others that show a cell's place on the surface; returns their number.
  size_t LookAround(size_t cell, std::array<PlaceSighting, kMostOthers>* seen) const {
    const CellPicture::Cell& own = picture_.cells[cell];
    const CellRay ray = RayOf(cell);
    if (own.usable == 0 || !std::isfinite(ray.distance_m)) return 0;
    const CellPicture::Range around = picture_.RangeAround(ColumnOf(cell), RowOf(cell));
    size_t n = 0;
    for (size_t i = 0; i < others_.size() && n < kMostOthers; ++i) {
      const std::optional<PlaceSighting> sighting = views_.Look(others_[i], ray.origin + ray.distance_m * ray.direction, own, around, true);
      if (sighting) (*seen)[n++] = *sighting;
    }
    return n;
  }

  // Takes away what the photo differs from the others over several metres: the bright spot opposite the sun, clouds, exposure. Nothing moves there.
  void RemoveSmoothDifference() {
    const int columns = (picture_.columns + kSmoothCells - 1) / kSmoothCells, rows = (picture_.rows + kSmoothCells - 1) / kSmoothCells;
    const auto at = [&](int column, int row) {
      return static_cast<size_t>(std::clamp(row, 0, rows - 1)) * static_cast<size_t>(columns) +
             static_cast<size_t>(std::clamp(column, 0, columns - 1));
    };
    std::vector<std::array<std::vector<float>, 3>> differences(static_cast<size_t>(columns) * static_cast<size_t>(rows));
    std::array<PlaceSighting, kMostOthers> seen;
    for (size_t cell = 0; cell < picture_.cells.size(); ++cell) {
      if (ColumnOf(cell) % 2 != 0 || RowOf(cell) % 2 != 0) continue;
      const size_t n = LookAround(cell, &seen);
      if (n < kLeastOthers) continue;
      const std::array<float, 3> median = MedianColor(std::span(seen).first(n));
      auto& of_square = differences[at(ColumnOf(cell) / kSmoothCells, RowOf(cell) / kSmoothCells)];
      for (size_t c = 0; c < 3; ++c) of_square[c].push_back(static_cast<float>(picture_.cells[cell].rgb[c]) / CellPicture::kUnits - median[c]);
    }
    // Medians over 3 x 3 squares, which are larger than what is looked for.
    std::vector<std::array<float, 3>> smooth(differences.size(), std::array<float, 3>{});
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        for (size_t c = 0; c < 3; ++c) {
          std::vector<float> around;
          for (int v = std::max(0, row - 1); v <= std::min(rows - 1, row + 1); ++v) {
            for (int u = std::max(0, column - 1); u <= std::min(columns - 1, column + 1); ++u) {
              around.insert(around.end(), differences[at(u, v)][c].begin(), differences[at(u, v)][c].end());
            }
          }
          if (around.size() < static_cast<size_t>(kSmoothCells)) continue;
          const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
          std::nth_element(around.begin(), middle, around.end());
          smooth[at(column, row)][c] = *middle;
        }
      }
    }
    for (size_t cell = 0; cell < picture_.cells.size(); ++cell) {
      const float x = (static_cast<float>(ColumnOf(cell)) + 0.5F) / kSmoothCells - 0.5F,
                  y = (static_cast<float>(RowOf(cell)) + 0.5F) / kSmoothCells - 0.5F;
      const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
      const float u = x - static_cast<float>(left), v = y - static_cast<float>(top);
      for (size_t c = 0; c < 3; ++c) {
        const float above = (1.0F - u) * smooth[at(left, top)][c] + u * smooth[at(left + 1, top)][c];
        const float below = (1.0F - u) * smooth[at(left, top + 1)][c] + u * smooth[at(left + 1, top + 1)][c];
        uint8_t& value = picture_.cells[cell].rgb[c];
        value = static_cast<uint8_t>(
            std::clamp(std::lround(static_cast<float>(value) - CellPicture::kUnits * ((1.0F - v) * above + v * below)), 0L, 255L));
      }
    }
  }

  void Judge(size_t cell) {
    std::array<PlaceSighting, kMostOthers> seen;
    const size_t n = LookAround(cell, &seen);
    std::array<float, kMostOthers> differences;
    size_t strong = 0, weak = 0, own_weak = 0;
    for (size_t i = 0; i < n; ++i) {
      differences[i] = side_ == Side::kBoth ? std::max(seen[i].own, seen[i].place) : seen[i].own;
      strong += differences[i] > kStrong ? 1 : 0;
      weak += differences[i] > kWeak ? 1 : 0;
      own_weak += seen[i].own > kWeak ? 1 : 0;
    }
    if (n < kLeastOthers) return;
    verdict_[cell] = Verdict::kAgrees;
    const std::array<float, 3> median = MedianColor(std::span(seen).first(n));
    if (weak < Majority(n) || Agreeing(std::span(seen).first(n), median) < Majority(n)) return;
    verdict_[cell] = strong >= Majority(n) ? Verdict::kStrong : Verdict::kWeak;
    // What others show and this photo does not is nothing in this photo that could stand elsewhere.
    if (own_weak < Majority(n)) explained_[cell] = 0;
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(differences.begin(), middle, differences.begin() + static_cast<std::ptrdiff_t>(n));
    difference_[cell] = *middle;
  }

  static std::array<float, 3> MedianColor(std::span<const PlaceSighting> seen) {
    std::array<float, 3> median{};
    for (size_t c = 0; c < 3; ++c) {
      std::array<float, kMostOthers> values;
      for (size_t i = 0; i < seen.size(); ++i) values[i] = seen[i].rgb[c];
      const auto middle = values.begin() + static_cast<std::ptrdiff_t>(seen.size() / 2);
      std::nth_element(values.begin(), middle, values.begin() + static_cast<std::ptrdiff_t>(seen.size()));
      median[c] = *middle;
    }
    return median;
  }

  // How many are near the median colour of all.
  static size_t Agreeing(std::span<const PlaceSighting> seen, const std::array<float, 3>& median) {
    return static_cast<size_t>(std::ranges::count_if(seen, [&](const PlaceSighting& one) {
      float most = 0.0F;
      for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(one.rgb[c] - median[c]));
      return most <= kAgree;
    }));
  }

  // What the photo shows must somewhere be two cells wide: lamps, wires and edges are thin, and easily misplaced. What others show is wide in them,
  // but they agree about its middle only.
  bool IsLarge(const Thing& thing) const {
    if (side_ == Side::kBoth) return thing.cells.size() >= kFewestCells;
    const std::set<size_t> cells(thing.cells.begin(), thing.cells.end());
    const auto columns = static_cast<size_t>(picture_.columns);
    return std::ranges::any_of(thing.cells, [&](size_t cell) {
      return ColumnOf(cell) + 1 < picture_.columns && cells.contains(cell + 1) && cells.contains(cell + columns) &&
             cells.contains(cell + columns + 1);
    });
  }

  // Whether the cell shows something that stands still at another distance than that of the context's surface. Found out when it is asked for.
  bool Explained(size_t cell) {
    if (explained_[cell] >= 0) return explained_[cell] == 1;
    const CellPicture::Cell& own = picture_.cells[cell];
    const CellRay ray = RayOf(cell);
    const CellPicture::Range around = picture_.RangeAround(ColumnOf(cell), RowOf(cell));
    bool explained = false;
    for (int k = 0; k < kDistances && !explained; ++k) {
      const double part = kNearest + (kFarthest - kNearest) * k / (kDistances - 1);
      const Eigen::Vector3d place = ray.origin + part * ray.distance_m * ray.direction;
      size_t n = 0, agree = 0;
      for (const size_t other : others_) {
        const std::optional<PlaceSighting> sighting = views_.Look(other, place, own, around, false);
        if (!sighting) continue;
        agree += sighting->own <= kWeak ? 1 : 0;
        if (++n == kMostOthers) break;
      }
      explained = n >= kLeastOthers && static_cast<double>(agree) >= kExplains * static_cast<double>(n);
    }
    explained_[cell] = explained ? 1 : 0;
    return explained;
  }

  const RaySource& source_;
  const PhotoViews& views_;
  CellPicture picture_;
  size_t photo_;
  std::vector<size_t> others_;
  Side side_;
  int cell_px_;
  std::vector<Verdict> verdict_;   // per cell
  std::vector<float> difference_;  // per cell that differs: median over the photos
  std::vector<int8_t> explained_;  // per cell: -1 not looked at yet
};

// Training photos that look in a similar direction from nearby; later: of later flights only.
std::vector<size_t> PhotosAround(const survey::Survey& survey, const PhotoViews& views, size_t photo, bool later) {
  std::vector<std::pair<double, size_t>> others;
  for (size_t i = 0; i < views.size(); ++i) {
    if (i == photo || views[i].picture.cells.empty() || views[i].axis.dot(views[photo].axis) < kLeastAxisCosine) continue;
    if (later && survey.photos[i].flight <= survey.photos[photo].flight) continue;
    others.emplace_back((views[i].eye - views[photo].eye).squaredNorm(), i);
  }
  const size_t n = std::min(kPhotosAround, others.size());
  std::partial_sort(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(n), others.end());
  std::vector<size_t> nearest;
  for (size_t i = 0; i < n; ++i) nearest.push_back(others[i].second);
  return nearest;
}

struct Found {
  std::vector<uint8_t> cells;  // not 0: rejected; empty: the photo was not compared
  size_t differing = 0;        // cells, before the limit
  size_t compared = 0;
};

// Things and the cells around them, until the share `most` of the photo is reached; those with most evidence first.
Found Reject(PhotoComparison comparison, size_t cells, double most) {
  Found found{.cells = std::vector<uint8_t>(cells, 0), .compared = comparison.Compared()};
  const auto limit = static_cast<size_t>(most * static_cast<double>(cells));
  size_t rejected = 0;
  for (const Thing& thing : comparison.Things()) {
    found.differing += thing.cells.size();
    if (rejected + thing.cells.size() > limit) continue;
    rejected += thing.cells.size();
    for (const size_t cell : thing.cells) {
      found.cells[cell] = 1;
      comparison.ForNeighbours(cell, true, [&](size_t beside) { found.cells[beside] = 1; });
    }
  }
  return found;
}

}  // namespace

int CellPixels(const survey::Survey& survey, const image::PixelCache& pixels, double gsd_m, double bytes) {
  double all = 0.0;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (!survey.photos[i].is_test) all += static_cast<double>(pixels.Width(i)) * pixels.Height(i);
  }
  int cell_px = kCellPixelsWithoutScale;
  if (std::isfinite(gsd_m)) cell_px = static_cast<int>(std::clamp(std::round(kCell_m / gsd_m), double{kFewestCellPixels}, double{kMostCellPixels}));
  while (all / (cell_px * cell_px) * static_cast<double>(sizeof(CellPicture::Cell) + sizeof(float)) > bytes) ++cell_px;
  return cell_px;
}

Movers FindMovers(const survey::Survey& survey, const RaySource& source, const PhotoViews& views, const RobustOptions& options, int cell_px,
                  base::ThreadPool& threads) {
  std::vector<Found> movers(views.size()), replaced(views.size());
  base::Progress progress("comparing photos", static_cast<double>(views.size()), "photos");
  threads.ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t task, int /*thread*/) {
    const auto photo = static_cast<size_t>(task);
    const size_t cells = views[photo].picture.cells.size();
    if (cells == 0 || base::CancelRequested()) return;
    if (options.movers != "off") {
      movers[photo] = Reject({source, views, photo, PhotosAround(survey, views, photo, false), Side::kOwn, cell_px}, cells, kMostMovers);
    }
    if (options.prefer == "latest") {
      std::vector<size_t> later = PhotosAround(survey, views, photo, true);
      if (!later.empty()) replaced[photo] = Reject({source, views, photo, std::move(later), Side::kBoth, cell_px}, cells, kMostLater);
    }
    progress.Advance();
  });
  base::ThrowIfCancelled();
  progress.Finish();
  const auto share = [&](const std::vector<Found>& found, size_t Found::*count) {
    double cells = 0.0, counted = 0.0;
    for (const Found& one : found) {
      cells += static_cast<double>(one.cells.size());
      counted += static_cast<double>(one.*count);
    }
    return cells > 0.0 ? counted / cells : 0.0;
  };
  Movers result{.pixels = {views.size(), cell_px},
                .compared = share(movers, &Found::compared),
                .moved = share(movers, &Found::differing),
                .replaced = share(replaced, &Found::differing)};
  result.unclear = options.movers == "auto" && result.moved > kMostMovers;
  for (size_t i = 0; i < views.size(); ++i) {
    std::vector<uint8_t> cells = std::move(replaced[i].cells);
    if (!result.unclear && !movers[i].cells.empty()) {
      if (cells.empty()) cells.resize(movers[i].cells.size(), 0);
      std::ranges::transform(cells, movers[i].cells, cells.begin(), [](uint8_t a, uint8_t b) { return static_cast<uint8_t>(a | b); });
    }
    if (!cells.empty()) result.pixels.Set(i, views[i].picture.columns, views[i].picture.rows, cells);
  }
  return result;
}

}  // namespace skyquilt::worker
