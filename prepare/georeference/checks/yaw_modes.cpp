#include "prepare/georeference/checks/yaw_modes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <numbers>
#include <utility>

namespace skyquilt::prepare::georeference {
namespace {

using survey::YawDifference;

constexpr double kBandwidth_deg = 2.0;
constexpr double kSameMode_deg = 3.0;
constexpr double kLongestLine_m = 40.0;
// A mode has at least this many lines, and at least twice the length that lines in any direction would have there.
constexpr int kFewestLines = 30;
constexpr double kLeastShare = 2.0 * (2.0 * survey::kModeReach_deg / 90.0);
constexpr size_t kMostModes = 4;
constexpr double kCell_m = 40.0;
constexpr double kLeastCellLength_m = 60.0, kLeastCellShare = 0.5;

double Weight(const HorizontalLine& line) {
  return std::min(line.length_m, kLongestLine_m);
}

double Gauss(double off_deg) {
  return std::exp(-0.5 * off_deg * off_deg / (kBandwidth_deg * kBandwidth_deg));
}

double Wrapped(double yaw_deg) {
  const double wrapped = std::fmod(std::fmod(yaw_deg, 90.0) + 90.0, 90.0);
  return wrapped < 90.0 ? wrapped : 0.0;
}

// Local maxima of the density of lines, to kStep_deg.
std::vector<double> Peaks(const std::vector<HorizontalLine>& lines) {
  constexpr int kSteps = 180;
  constexpr double kStep_deg = 90.0 / kSteps;
  std::vector<double> density(kSteps, 0.0), peaks;
  for (size_t i = 0; i < kSteps; ++i) {
    for (const HorizontalLine& line : lines) density[i] += Weight(line) * Gauss(YawDifference(line.yaw_deg, static_cast<double>(i) * kStep_deg));
  }
  for (size_t i = 0; i < kSteps; ++i) {
    if (density[i] > density[(i + kSteps - 1) % kSteps] && density[i] >= density[(i + 1) % kSteps])
      peaks.push_back(static_cast<double>(i) * kStep_deg);
  }
  return peaks;
}

// Where mean shift from `yaw_deg` ends.
double MeanShift(const std::vector<HorizontalLine>& lines, double yaw_deg) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    double weight = 0.0, moment = 0.0;
    for (const HorizontalLine& line : lines) {
      const double off = YawDifference(line.yaw_deg, yaw_deg);
      const double w = Weight(line) * Gauss(off);
      weight += w;
      moment += w * off;
    }
    if (!(weight > 0.0)) break;
    yaw_deg = Wrapped(yaw_deg + moment / weight);
    if (std::abs(moment / weight) < 1e-4) break;
  }
  return yaw_deg;
}

survey::YawMode Describe(const std::vector<HorizontalLine>& lines, double yaw_deg, double total) {
  survey::YawMode mode{.yaw_deg = yaw_deg};
  double weight = 0.0, squares = 0.0, spread = 0.0;
  for (const HorizontalLine& line : lines) {
    const double off = YawDifference(line.yaw_deg, yaw_deg);
    if (std::abs(off) > survey::kModeReach_deg) continue;
    const double w = Weight(line);
    weight += w;
    squares += w * w;
    spread += w * off * off;
    ++mode.lines;
  }
  if (!(weight > 0.0)) return mode;
  mode.share = weight / total;
  mode.spread_deg = std::sqrt(spread / weight);
  mode.sigma_deg = mode.spread_deg / std::sqrt(weight * weight / squares);
  return mode;
}

void AddCells(const std::vector<HorizontalLine>& lines, survey::DominantDirections& directions) {
  directions.cell_m = kCell_m;
  struct Cell {
    double total = 0.0;
    std::vector<double> of_mode;
  };
  std::map<std::pair<long, long>, Cell> cells;
  for (const HorizontalLine& line : lines) {
    Cell& cell = cells[{std::lround(std::floor(line.place_enu.y() / kCell_m)), std::lround(std::floor(line.place_enu.x() / kCell_m))}];
    cell.of_mode.resize(directions.modes.size());
    cell.total += Weight(line);
    const int mode = directions.ModeNear(line.yaw_deg);
    if (mode >= 0) cell.of_mode[static_cast<size_t>(mode)] += Weight(line);
  }
  for (const auto& [index, cell] : cells) {
    if (cell.of_mode.empty() || cell.total < kLeastCellLength_m) continue;
    const auto best = std::max_element(cell.of_mode.begin(), cell.of_mode.end());
    if (*best < kLeastCellShare * cell.total) continue;
    directions.cells.push_back({{static_cast<double>(index.second) * kCell_m, static_cast<double>(index.first) * kCell_m},
                                static_cast<int>(best - cell.of_mode.begin()),
                                *best / cell.total});
  }
}

}  // namespace

survey::DominantDirections FindDirections(const std::vector<HorizontalLine>& lines, int photos) {
  survey::DominantDirections directions;
  directions.photos = photos;
  directions.lines = static_cast<int>(lines.size());
  double total = 0.0;
  std::complex<double> mean = 0.0;
  for (const HorizontalLine& line : lines) {
    total += Weight(line);
    directions.length_m += line.length_m;
    mean += std::polar(Weight(line), 4.0 * line.yaw_deg * std::numbers::pi / 180.0);
  }
  if (!(total > 0.0)) return directions;
  directions.concentration = std::abs(mean) / total;
  for (const HorizontalLine& line : lines) {
    directions.histogram[std::min<size_t>(89, static_cast<size_t>(Wrapped(line.yaw_deg)))] += Weight(line) / total;
  }
  std::vector<survey::YawMode> found;
  for (const double peak_deg : Peaks(lines)) {
    const double yaw_deg = MeanShift(lines, peak_deg);
    const bool known = std::any_of(found.begin(), found.end(),
                                   [&](const survey::YawMode& mode) { return std::abs(YawDifference(mode.yaw_deg, yaw_deg)) < kSameMode_deg; });
    if (!known) found.push_back(Describe(lines, yaw_deg, total));
  }
  std::erase_if(found, [](const survey::YawMode& mode) { return mode.lines < kFewestLines || mode.share < kLeastShare; });
  std::sort(found.begin(), found.end(), [](const survey::YawMode& a, const survey::YawMode& b) { return a.share > b.share; });
  if (found.size() > kMostModes) found.resize(kMostModes);
  directions.modes = std::move(found);
  AddCells(lines, directions);
  return directions;
}

}  // namespace skyquilt::prepare::georeference
