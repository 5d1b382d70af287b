#include "buildings/geometry/planar_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "buildings/geometry/rings.h"
#include "buildings/geometry/snapped_segments.h"
#include "core/base/disjoint_sets.h"

namespace skyquilt::buildings {

PlanarMap::PlanarMap(std::span<const Segment> segments, double snap_m) {
  SnappedSegments snapped = Snap(segments, snap_m);
  vertex_ = std::move(snapped.vertex);
  for (const auto& [a, b] : snapped.edges) {
    from_.push_back(a);
    from_.push_back(b);
  }
  FindFaces();
}

std::vector<std::vector<uint32_t>> PlanarMap::RingsOfFaces() {
  std::vector<std::vector<uint32_t>> out(vertex_.size());
  std::vector<double> angle(from_.size());
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    const Eigen::Vector2d along = vertex_[To(h)] - vertex_[From(h)];
    angle[h] = std::atan2(along.y(), along.x());
    out[From(h)].push_back(h);
  }
  next_.assign(from_.size(), 0);
  for (std::vector<uint32_t>& around : out) {
    std::sort(around.begin(), around.end(), [&](uint32_t g, uint32_t h) { return std::pair(angle[g], g) < std::pair(angle[h], h); });
    // A face goes on with the edge that follows clockwise on the one back to where it came from.
    for (size_t i = 0; i < around.size(); ++i) next_[Twin(around[i])] = around[(i + around.size() - 1) % around.size()];
  }
  std::vector<std::vector<uint32_t>> rings;
  std::vector<bool> seen(from_.size(), false);
  for (uint32_t start = 0; start < HalfEdges(); ++start) {
    if (seen[start]) continue;
    rings.emplace_back();
    for (uint32_t h = start; !seen[h]; h = next_[h]) {
      seen[h] = true;
      rings.back().push_back(h);
    }
  }
  return rings;
}

void PlanarMap::FindFaces() {
  const std::vector<std::vector<uint32_t>> rings = RingsOfFaces();
  base::DisjointSets connected(vertex_.size());
  for (uint32_t h = 0; h < HalfEdges(); h += 2) connected.Join(From(h), To(h));
  struct Around {
    Ring place;
    double area = 0.0;
    int face = -1;
  };
  std::vector<Around> around(rings.size());
  for (size_t r = 0; r < rings.size(); ++r) {
    for (const uint32_t h : rings[r]) around[r].place.push_back(vertex_[From(h)]);
    around[r].area = SignedArea(around[r].place);
    if (around[r].area > 0.0) around[r].face = n_faces_++;
  }
  // The ring around a connected piece is a hole of the least face of another piece that contains it.
  for (size_t r = 0; r < rings.size(); ++r) {
    if (around[r].area > 0.0) continue;
    double least = std::numeric_limits<double>::infinity();
    for (size_t s = 0; s < rings.size(); ++s) {
      if (!(around[s].area > 0.0) || around[s].area >= least) continue;
      if (connected.Root(From(rings[r].front())) == connected.Root(From(rings[s].front()))) continue;
      if (!RingContains(around[s].place, around[r].place.front())) continue;
      least = around[s].area;
      around[r].face = around[s].face;
    }
  }
  face_.assign(from_.size(), -1);
  for (size_t r = 0; r < rings.size(); ++r) {
    for (const uint32_t h : rings[r]) face_[h] = around[r].face;
  }
}

std::vector<double> PlanarMap::FaceAreas() const {
  std::vector<double> area(static_cast<size_t>(n_faces_), 0.0);
  if (vertex_.empty()) return area;
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    if (face_[h] >= 0) area[static_cast<size_t>(face_[h])] += 0.5 * Cross2(vertex_[From(h)] - vertex_[0], vertex_[To(h)] - vertex_[0]);
  }
  return area;
}

std::vector<Eigen::Vector2d> PlanarMap::PointsInFaces() const {
  std::vector<std::vector<uint32_t>> edges(static_cast<size_t>(n_faces_));
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    if (face_[h] >= 0) edges[static_cast<size_t>(face_[h])].push_back(h);
  }
  std::vector<Eigen::Vector2d> points;
  for (const std::vector<uint32_t>& own : edges) {
    std::vector<double> levels;
    for (const uint32_t h : own) levels.push_back(vertex_[From(h)].y());
    std::sort(levels.begin(), levels.end());
    Eigen::Vector2d best = vertex_[From(own.front())];
    double largest = 0.0;
    // The middle of the largest stretch inside, on lines halfway between vertices.
    for (size_t i = 0; i + 1 < levels.size(); ++i) {
      const double y = 0.5 * (levels[i] + levels[i + 1]), height = levels[i + 1] - levels[i];
      if (!(height > 0.0)) continue;
      std::vector<double> crossings;
      for (const uint32_t h : own) {
        const Eigen::Vector2d &a = vertex_[From(h)], &b = vertex_[To(h)];
        if ((a.y() > y) != (b.y() > y)) crossings.push_back(a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()));
      }
      std::sort(crossings.begin(), crossings.end());
      for (size_t k = 0; k + 1 < crossings.size(); k += 2) {
        const double size = height * (crossings[k + 1] - crossings[k]);
        if (size > largest) {
          largest = size;
          best = {0.5 * (crossings[k] + crossings[k + 1]), y};
        }
      }
    }
    points.push_back(best);
  }
  return points;
}

int PlanarMap::LabelOf(uint32_t h, std::span<const int> label) const {
  return face_[h] < 0 ? -1 : std::max(label[static_cast<size_t>(face_[h])], -1);
}

std::vector<int> PlanarMap::Components(std::span<const int> label) const {
  base::DisjointSets groups(label.size());
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    const int a = face_[h], b = face_[Twin(h)];
    if (a >= 0 && b >= 0 && label[static_cast<size_t>(a)] == label[static_cast<size_t>(b)])
      groups.Join(static_cast<uint32_t>(a), static_cast<uint32_t>(b));
  }
  std::vector<int> number(label.size(), -1), component;
  int n = 0;
  for (uint32_t f = 0; f < label.size(); ++f) {
    int& of_group = number[groups.Root(f)];
    if (of_group < 0) of_group = n++;
    component.push_back(of_group);
  }
  return component;
}

std::vector<MapRegion> PlanarMap::Regions(std::span<const int> label, double straight_m) const {
  const auto kept = [&](uint32_t h) { return LabelOf(h, label) != LabelOf(Twin(h), label); };
  // Around the region on the left: edges with the same label on both sides are passed over.
  const auto next = [&](uint32_t h) {
    uint32_t n = next_[h];
    while (!kept(n)) n = next_[Twin(n)];
    return n;
  };
  std::vector<int> uses(vertex_.size(), 0);
  for (uint32_t h = 0; h < HalfEdges(); ++h) uses[From(h)] += kept(h) ? 1 : 0;
  const std::vector<int> component = Components(label);
  std::vector<MapRegion> region(component.empty() ? 0 : static_cast<size_t>(*std::max_element(component.begin(), component.end())) + 1);
  std::vector<bool> seen(from_.size(), false);
  for (uint32_t start = 0; start < HalfEdges(); ++start) {
    if (seen[start] || !kept(start) || LabelOf(start, label) < 0) continue;
    std::vector<uint32_t> ring;
    for (uint32_t h = start; !seen[h]; h = next(h)) {
      seen[h] = true;
      // Straight on is judged from both sides by the same numbers.
      const uint32_t n = next(h);
      const bool straight = uses[To(h)] == 2 && DistanceToSegment(vertex_[To(h)], vertex_[From(h)], vertex_[To(n)]) <= straight_m;
      if (!straight) ring.push_back(To(h));
    }
    MapRegion& own = region[static_cast<size_t>(component[static_cast<size_t>(face_[start])])];
    own.label = LabelOf(start, label);
    for (std::vector<uint32_t>& simple : SplitAtRepeats(ring)) {
      Ring place;
      for (const uint32_t v : simple) place.push_back(vertex_[v]);
      if (SignedArea(place) > 0.0) {
        own.outer = std::move(simple);
      } else {
        own.holes.push_back(std::move(simple));
      }
    }
  }
  std::erase_if(region, [](const MapRegion& r) { return r.outer.empty(); });
  std::stable_sort(region.begin(), region.end(), [](const MapRegion& a, const MapRegion& b) { return a.label < b.label; });
  return region;
}

Polygon PlanarMap::OutlineOf(const MapRegion& region) const {
  const auto places = [&](const std::vector<uint32_t>& ring) {
    Ring place;
    for (const uint32_t v : ring) place.push_back(vertex_[v]);
    return place;
  };
  Polygon polygon{places(region.outer), {}};
  for (const std::vector<uint32_t>& hole : region.holes) polygon.holes.push_back(places(hole));
  return polygon;
}

}  // namespace skyquilt::buildings
