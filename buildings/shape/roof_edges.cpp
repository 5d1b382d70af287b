#include "buildings/shape/roof_edges.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::buildings {
namespace {

constexpr double kStep_m = 0.6;
constexpr double kStepPerSlope_m = 0.2;  // more where roofs are steep: points lie anywhere in their cell
constexpr double kRounded_m = 0.35;      // on each side of a step, where the surface is rounded
constexpr double kSide_m = 1.3;          // of roof on each side that tells its height at the step
constexpr int kFewest = 3;               // cells of it

// A line through the heights of a side, with x = 0 at the border.
struct SideLine {
  double height = 0.0, slope = 0.0;
  bool found = false;
};

SideLine LineThrough(const std::vector<float>& profile, int border, int direction, int skipped, int taken) {
  double n = 0.0, sx = 0.0, sz = 0.0, sxx = 0.0, sxz = 0.0;
  for (int k = skipped; k < skipped + taken; ++k) {
    const int cell = direction > 0 ? border + k : border - 1 - k;
    if (cell < 0 || cell >= static_cast<int>(profile.size())) break;
    const auto z = static_cast<double>(profile[static_cast<size_t>(cell)]);
    if (!std::isfinite(z)) break;
    const double x = direction * (k + 0.5);
    n += 1.0;
    sx += x;
    sz += z;
    sxx += x * x;
    sxz += x * z;
  }
  if (n < kFewest) return {};
  const double slope = (sxz - sx * sz / n) / (sxx - sx * sx / n);
  return {(sz - slope * sx) / n, slope, true};
}

class EdgeFinder {
 public:
  EdgeFinder(const RoofRaster& raster, int axis)
      : raster_(raster),
        axis_(axis),
        lanes_(axis == 0 ? raster.rows : raster.columns),
        cells_(axis == 0 ? raster.columns : raster.rows),
        skipped_(std::max(1, static_cast<int>(std::lround(kRounded_m / raster.cell_m)))),
        taken_(std::max(kFewest, static_cast<int>(std::lround(kSide_m / raster.cell_m)))) {}

  EdgesAcross Find() const {
    EdgesAcross edges{lanes_, cells_ + 1, std::vector<RoofEdge>(static_cast<size_t>(lanes_) * static_cast<size_t>(cells_ + 1), RoofEdge::kNone)};
    std::vector<double> jump;
    for (int lane = 0; lane < lanes_; ++lane) {
      RoofEdge* out = edges.edge.data() + static_cast<size_t>(lane) * static_cast<size_t>(cells_ + 1);
      Jumps(lane, &jump);
      for (int border = 0; border <= cells_; ++border) {
        if (IsCovered(lane, border - 1) != IsCovered(lane, border)) {
          out[border] = RoofEdge::kOutline;
        } else if (jump[static_cast<size_t>(border)] > kStep_m && IsLargestAround(jump, border)) {
          out[border] = RoofEdge::kStep;
        }
      }
    }
    return edges;
  }

 private:
  size_t CellOf(int lane, int cell) const { return axis_ == 0 ? raster_.Index(cell, lane) : raster_.Index(lane, cell); }
  bool IsCovered(int lane, int cell) const { return cell >= 0 && cell < cells_ && raster_.covered[CellOf(lane, cell)] != 0; }

  // Mean heights of the lane and its neighbours, which damps noise and keeps steps across the lane.
  std::vector<float> Profile(int lane) const {
    std::vector<float> profile(static_cast<size_t>(cells_), std::numeric_limits<float>::quiet_NaN());
    for (int cell = 0; cell < cells_; ++cell) {
      const float own = raster_.height[CellOf(lane, cell)];
      if (!std::isfinite(own)) continue;
      float sum = own;
      int count = 1;
      for (const int other : {lane - 1, lane + 1}) {
        if (other < 0 || other >= lanes_) continue;
        const float height = raster_.height[CellOf(other, cell)];
        if (!std::isfinite(height)) continue;
        sum += height;
        ++count;
      }
      profile[static_cast<size_t>(cell)] = sum / static_cast<float>(count);
    }
    return profile;
  }

  // Per border the least distance between the lines of both sides over the rounded stretch; 0 where they meet there, as at ridges.
  void Jumps(int lane, std::vector<double>* jump) const {
    const std::vector<float> profile = Profile(lane);
    jump->assign(static_cast<size_t>(cells_) + 1, 0.0);
    for (int border = 1; border < cells_; ++border) {
      const SideLine before = LineThrough(profile, border, -1, skipped_, taken_);
      const SideLine after = LineThrough(profile, border, 1, skipped_, taken_);
      if (!before.found || !after.found) continue;
      const double middle = after.height - before.height, turn = (after.slope - before.slope) * (skipped_ + 0.5);
      const double low = middle - turn, high = middle + turn;
      const double excess = std::min(std::abs(low), std::abs(high)) - kStepPerSlope_m * (std::abs(before.slope) + std::abs(after.slope));
      if (low * high > 0.0) (*jump)[static_cast<size_t>(border)] = std::max(0.0, excess);
    }
  }

  bool IsLargestAround(const std::vector<double>& jump, int border) const {
    // Beyond it no line of a side crosses the step: nearer ones would seem to jump as well.
    const int reach = skipped_ + taken_;
    for (int other = std::max(0, border - reach); other <= std::min(cells_, border + reach); ++other) {
      const double here = jump[static_cast<size_t>(border)], there = jump[static_cast<size_t>(other)];
      if (there > here || (there == here && other < border)) return false;
    }
    return true;
  }

  const RoofRaster& raster_;
  int axis_, lanes_, cells_, skipped_, taken_;
};

}  // namespace

std::array<EdgesAcross, 2> FindRoofEdges(const RoofRaster& raster) {
  return {EdgeFinder(raster, 0).Find(), EdgeFinder(raster, 1).Find()};
}

double ShareWithEdge(const RoofRaster& raster, const EdgesAcross& edges, int axis, double at, double from, double to, double reach_m, RoofEdge only) {
  const RoofRaster::Range lanes = raster.Between(1 - axis, from, to);
  if (lanes.last <= lanes.first) return 0.0;
  const double place = (at - raster.origin[axis]) / raster.cell_m, reach = reach_m / raster.cell_m;
  const int first = std::max(0, static_cast<int>(std::ceil(place - reach))), last = std::min(edges.borders - 1, static_cast<int>(place + reach));
  int count = 0;
  for (int lane = lanes.first; lane < lanes.last; ++lane) {
    for (int border = first; border <= last; ++border) {
      const RoofEdge edge = edges.At(lane, border);
      if (edge == RoofEdge::kNone || (only != RoofEdge::kNone && edge != only)) continue;
      ++count;
      break;
    }
  }
  return static_cast<double>(count) / (lanes.last - lanes.first);
}

}  // namespace skyquilt::buildings
