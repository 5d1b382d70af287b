#include "buildings/geometry/snapped_segments.h"

#include <algorithm>
#include <map>
#include <optional>

#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

using Edge = std::pair<uint32_t, uint32_t>;

class Snapper {
 public:
  explicit Snapper(double snap_m) : snap_m_(snap_m) {}

  SnappedSegments Run(std::span<const Segment> segments) {
    for (const Segment& segment : segments) {
      if (!segment.a.allFinite() || !segment.b.allFinite()) continue;
      const uint32_t a = VertexAt(segment.a), b = VertexAt(segment.b);
      if (a != b) made_.edges.insert(std::minmax(a, b));
    }
    // Edges bend when they are drawn to a vertex and can then pass others.
    constexpr int kRounds = 30;
    for (int round = 0; round < kRounds; ++round) {
      if (CutAtVertices()) continue;
      if (!CutAtCrossings()) break;
    }
    return std::move(made_);
  }

 private:
  const Eigen::Vector2d& At(uint32_t v) const { return made_.vertex[v]; }

  // The nearest vertex within the tolerance, or a new one.
  uint32_t VertexAt(const Eigen::Vector2d& place) {
    std::optional<uint32_t> nearest;
    double least = snap_m_;
    const Eigen::Array2d cell = (place.array() / snap_m_).floor();
    for (const double column : {cell.x() - 1.0, cell.x(), cell.x() + 1.0}) {
      for (const double row : {cell.y() - 1.0, cell.y(), cell.y() + 1.0}) {
        const auto found = in_cell_.find({column, row});
        if (found == in_cell_.end()) continue;
        for (const uint32_t v : found->second) {
          const double distance = (At(v) - place).norm();
          if (distance > least) continue;
          least = distance;
          nearest = v;
        }
      }
    }
    if (nearest) return *nearest;
    const auto v = static_cast<uint32_t>(made_.vertex.size());
    made_.vertex.push_back(place);
    in_cell_[{cell.x(), cell.y()}].push_back(v);
    return v;
  }

  // Leads an edge through vertices. Whether anything changed.
  bool Lead(const Edge& edge, std::vector<uint32_t> through) {
    const Eigen::Vector2d along = At(edge.second) - At(edge.first);
    std::erase_if(through, [&](uint32_t v) { return v == edge.first || v == edge.second; });
    if (through.empty()) return false;
    std::sort(through.begin(), through.end(), [&](uint32_t v, uint32_t w) {
      const double at_v = At(v).dot(along), at_w = At(w).dot(along);
      return at_v < at_w || (at_v == at_w && v < w);
    });
    through.erase(std::unique(through.begin(), through.end()), through.end());
    through.push_back(edge.second);
    made_.edges.erase(edge);
    uint32_t before = edge.first;
    for (const uint32_t v : through) {
      made_.edges.insert(std::minmax(before, v));
      before = v;
    }
    return true;
  }

  bool CutAtVertices() {
    bool changed = false;
    const std::vector<Edge> edges(made_.edges.begin(), made_.edges.end());
    std::vector<std::pair<double, uint32_t>> by_x;
    for (uint32_t v = 0; v < made_.vertex.size(); ++v) by_x.emplace_back(At(v).x(), v);
    std::sort(by_x.begin(), by_x.end());
    for (const Edge& edge : edges) {
      const Eigen::Vector2d &a = At(edge.first), &b = At(edge.second);
      const Eigen::Vector2d least = a.cwiseMin(b).array() - snap_m_, most = a.cwiseMax(b).array() + snap_m_, ab = b - a;
      std::vector<uint32_t> through;
      for (auto near = std::lower_bound(by_x.begin(), by_x.end(), std::pair(least.x(), 0U)); near != by_x.end() && near->first <= most.x(); ++near) {
        const uint32_t v = near->second;
        const Eigen::Vector2d& p = At(v);
        if (p.y() < least.y() || p.y() > most.y()) continue;
        const double along = (p - a).dot(ab);
        if (along > 0.0 && along < ab.squaredNorm() && DistanceToSegment(p, a, b) <= snap_m_) through.push_back(v);
      }
      changed |= Lead(edge, std::move(through));
    }
    return changed;
  }

  bool CutAtCrossings() {
    const std::vector<Edge> edges(made_.edges.begin(), made_.edges.end());
    std::vector<std::vector<uint32_t>> through(edges.size());
    const auto left = [&](const Edge& edge) { return std::min(At(edge.first).x(), At(edge.second).x()); };
    std::vector<size_t> order(edges.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](size_t i, size_t j) {
      const double at_i = left(edges[i]), at_j = left(edges[j]);
      return at_i < at_j || (at_i == at_j && i < j);
    });
    for (size_t k = 0; k < order.size(); ++k) {
      const Edge e = edges[order[k]];
      const double end = std::max(At(e.first).x(), At(e.second).x());
      for (size_t m = k + 1; m < order.size() && left(edges[order[m]]) <= end; ++m) {
        const Edge f = edges[order[m]];
        if (e.first == f.first || e.first == f.second || e.second == f.first || e.second == f.second) continue;
        const Eigen::Vector2d a = At(e.first), ab = At(e.second) - a, c = At(f.first), cd = At(f.second) - c;
        const double from_c = Cross2(ab, c - a), from_d = Cross2(ab, At(f.second) - a);
        const double from_a = Cross2(cd, a - c), from_b = Cross2(cd, At(e.second) - c);
        if ((from_c > 0.0) == (from_d > 0.0) || (from_a > 0.0) == (from_b > 0.0) || from_a == from_b) continue;
        const uint32_t v = VertexAt(a + from_a / (from_a - from_b) * ab);
        through[order[k]].push_back(v);
        through[order[m]].push_back(v);
      }
    }
    bool changed = false;
    for (size_t i = 0; i < edges.size(); ++i) changed |= Lead(edges[i], std::move(through[i]));
    return changed;
  }

  double snap_m_;
  SnappedSegments made_;
  std::map<std::pair<double, double>, std::vector<uint32_t>> in_cell_;  // vertices by place in units of snap_m_
};

}  // namespace

SnappedSegments Snap(std::span<const Segment> segments, double snap_m) {
  return Snapper(snap_m).Run(segments);
}

}  // namespace skyquilt::buildings
