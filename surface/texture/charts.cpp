#include "surface/texture/charts.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <utility>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr double kSmallChartTexels = 64.0;  // pieces with a smaller area join a neighbour: their gutters would need more texels than they do

bool Fits(const TileGeometry& geometry, const ChartDirections& directions, size_t t, int direction) {
  return geometry.face_normal[t].dot(directions[static_cast<size_t>(direction)].out) > kLeastChartCosine;
}

// Best direction per triangle, where triangles that all neighbours surround with another one follow them.
std::vector<int> DirectionPerTriangle(const TileGeometry& geometry, const ChartDirections& directions) {
  std::vector<int> best(geometry.triangle.size());
  for (size_t t = 0; t < best.size(); ++t) best[t] = BestDirection(directions, geometry.face_normal[t]);
  const std::vector<int> before = best;
  for (size_t t = 0; t < best.size(); ++t) {
    const std::array<int32_t, 3>& neighbor = geometry.neighbor[t];
    if (std::min({neighbor[0], neighbor[1], neighbor[2]}) < 0) continue;
    const int around = before[static_cast<size_t>(neighbor[0])];
    if (around == before[static_cast<size_t>(neighbor[1])] && around == before[static_cast<size_t>(neighbor[2])] &&
        Fits(geometry, directions, t, around)) {
      best[t] = around;
    }
  }
  return best;
}

// Triangles of one direction that are connected by edges.
std::vector<Chart> PiecesOf(const TileGeometry& geometry, const std::vector<int>& direction) {
  std::vector<Chart> pieces;
  std::vector<bool> seen(direction.size(), false);
  std::vector<uint32_t> open;
  for (size_t first = 0; first < direction.size(); ++first) {
    if (seen[first]) continue;
    Chart piece;
    piece.direction = direction[first];
    seen[first] = true;
    open.assign(1, static_cast<uint32_t>(first));
    while (!open.empty()) {
      const uint32_t t = open.back();
      open.pop_back();
      piece.triangle.push_back(t);
      for (const int32_t other : geometry.neighbor[t]) {
        if (other < 0 || seen[static_cast<size_t>(other)] || direction[static_cast<size_t>(other)] != piece.direction) continue;
        seen[static_cast<size_t>(other)] = true;
        open.push_back(static_cast<uint32_t>(other));
      }
    }
    std::sort(piece.triangle.begin(), piece.triangle.end());
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

class PieceMerger {
 public:
  PieceMerger(const TileGeometry& geometry, const ChartDirections& directions, std::vector<Chart> pieces)
      : geometry_(geometry), directions_(directions), pieces_(std::move(pieces)), owner_(geometry.triangle.size()), area_(pieces_.size(), 0.0) {
    for (size_t p = 0; p < pieces_.size(); ++p) {
      for (const uint32_t t : pieces_[p].triangle) {
        owner_[t] = p;
        area_[p] += geometry.area[t];
      }
    }
  }

  // The direction of each triangle after merging.
  std::vector<int> MergeSmallerThan(double area_m2) {
    using Item = std::pair<double, size_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> smallest;
    for (size_t p = 0; p < pieces_.size(); ++p) {
      if (area_[p] < area_m2) smallest.emplace(area_[p], p);
    }
    while (!smallest.empty()) {
      const auto [area, p] = smallest.top();
      smallest.pop();
      if (pieces_[p].triangle.empty() || area != area_[p]) continue;  // changed since it was queued
      const std::optional<size_t> target = TargetOf(p);
      if (!target) continue;
      Join(p, *target);
      if (area_[*target] < area_m2) smallest.emplace(area_[*target], *target);
    }
    std::vector<int> direction(owner_.size());
    for (size_t t = 0; t < owner_.size(); ++t) direction[t] = pieces_[owner_[t]].direction;
    return direction;
  }

 private:
  // The neighbour with the longest common border whose direction all triangles of the piece can take.
  std::optional<size_t> TargetOf(size_t piece) const {
    std::vector<std::pair<size_t, double>> border;  // neighbour, length
    for (const uint32_t t : pieces_[piece].triangle) {
      for (size_t side = 0; side < 3; ++side) {
        const int32_t other = geometry_.neighbor[t][side];
        if (other < 0 || owner_[static_cast<size_t>(other)] == piece) continue;
        border.emplace_back(owner_[static_cast<size_t>(other)], (geometry_.Corner(t, (side + 1) % 3) - geometry_.Corner(t, side)).norm());
      }
    }
    std::stable_sort(border.begin(), border.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::pair<size_t, double>> neighbors;
    for (const auto& [neighbor, length] : border) {
      if (neighbors.empty() || neighbors.back().first != neighbor) neighbors.emplace_back(neighbor, 0.0);
      neighbors.back().second += length;
    }
    std::stable_sort(neighbors.begin(), neighbors.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
    for (const auto& [neighbor, length] : neighbors) {
      const int direction = pieces_[neighbor].direction;
      const std::vector<uint32_t>& triangles = pieces_[piece].triangle;
      if (std::all_of(triangles.begin(), triangles.end(), [&](uint32_t t) { return Fits(geometry_, directions_, t, direction); })) return neighbor;
    }
    return std::nullopt;
  }

  void Join(size_t piece, size_t target) {
    for (const uint32_t t : pieces_[piece].triangle) owner_[t] = target;
    pieces_[target].triangle.insert(pieces_[target].triangle.end(), pieces_[piece].triangle.begin(), pieces_[piece].triangle.end());
    area_[target] += area_[piece];
    pieces_[piece].triangle.clear();
  }

  const TileGeometry& geometry_;
  const ChartDirections& directions_;
  std::vector<Chart> pieces_;
  std::vector<size_t> owner_;
  std::vector<double> area_;
};

}  // namespace

std::vector<Chart> ConnectedCharts(const TileGeometry& geometry, const ChartDirections& directions, double texel_m) {
  std::vector<Chart> pieces = PiecesOf(geometry, DirectionPerTriangle(geometry, directions));
  PieceMerger merger(geometry, directions, std::move(pieces));
  // Pieces of one direction may touch now that what was between them has joined.
  return PiecesOf(geometry, merger.MergeSmallerThan(kSmallChartTexels * texel_m * texel_m));
}

std::optional<std::vector<Chart>> MakeCharts(const TileGeometry& geometry, const TexelLattice& lattice, int max_size) {
  std::vector<Chart> charts;
  for (const Chart& piece : ConnectedCharts(geometry, lattice.directions, lattice.texel_m)) {
    base::ThrowIfCancelled();
    std::optional<std::vector<Chart>> parts = SplitOverlaps(geometry, lattice, piece, max_size);
    if (!parts) return std::nullopt;
    for (Chart& part : *parts) charts.push_back(std::move(part));
  }
  return charts;
}

}  // namespace skyquilt::surface
