// Outlines with fewer points.
#include <algorithm>
#include <utility>

#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

// Marks the points between two kept ones that are needed (Douglas and Peucker 1973). `to` may run past the end: the ring goes on from its start.
void Keep(const Ring& ring, size_t from, size_t to, double tolerance_m, std::vector<bool>* keep) {
  const size_t n = ring.size();
  std::vector<std::pair<size_t, size_t>> open = {{from, to}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    double farthest = tolerance_m;
    size_t at = a;
    for (size_t i = a + 1; i < b; ++i) {
      const double distance = DistanceToSegment(ring[i % n], ring[a % n], ring[b % n]);
      if (distance > farthest) {
        farthest = distance;
        at = i;
      }
    }
    if (at == a) continue;
    (*keep)[at % n] = true;
    open.emplace_back(a, at);
    open.emplace_back(at, b);
  }
}

Ring SimplifiedRing(const Ring& ring, double tolerance_m) {
  const size_t n = ring.size();
  if (n <= 3) return ring;
  // Two points that are surely corners: the one farthest from the middle, and the one farthest from that.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : ring) middle += p / static_cast<double>(n);
  const auto farthest = [&](const Eigen::Vector2d& from) {
    size_t best = 0;
    for (size_t i = 1; i < n; ++i) {
      if ((ring[i] - from).squaredNorm() > (ring[best] - from).squaredNorm()) best = i;
    }
    return best;
  };
  size_t a = farthest(middle), b = farthest(ring[a]);
  if (a > b) std::swap(a, b);
  std::vector<bool> keep(n, false);
  keep[a] = keep[b] = true;
  Keep(ring, a, b, tolerance_m, &keep);
  Keep(ring, b, a + n, tolerance_m, &keep);
  Ring simple;
  for (size_t i = 0; i < n; ++i) {
    if (keep[i]) simple.push_back(ring[i]);
  }
  return simple;
}

struct Side {
  Eigen::Vector2d a, b;
};

// Whether edges meet anywhere but in an end that they have in common.
bool Meet(const Side& e, const Side& f) {
  const double c = Cross2(e.b - e.a, f.a - e.a), d = Cross2(e.b - e.a, f.b - e.a);
  const double g = Cross2(f.b - f.a, e.a - f.a), h = Cross2(f.b - f.a, e.b - f.a);
  const bool shared = e.a == f.a || e.a == f.b || e.b == f.a || e.b == f.b;
  if (c == 0.0 && d == 0.0) {
    // On one line: their extents along it must not overlap.
    const Eigen::Vector2d along = e.b - e.a;
    const std::pair<double, double> of_e = std::minmax({e.a.dot(along), e.b.dot(along)}), of_f = std::minmax({f.a.dot(along), f.b.dot(along)});
    const double begin = std::max(of_e.first, of_f.first), end = std::min(of_e.second, of_f.second);
    return shared ? begin < end : begin <= end;
  }
  if (shared) return false;
  const auto apart = [](double s, double t) { return (s <= 0.0 && t >= 0.0) || (s >= 0.0 && t <= 0.0); };
  return apart(c, d) && apart(g, h);
}

bool IsSimple(const Polygon& polygon) {
  if (!(SignedArea(polygon.outer) > 0.0)) return false;
  std::vector<Side> sides;
  const auto add = [&](const Ring& ring) {
    for (size_t i = 0; i < ring.size(); ++i) sides.push_back({ring[i], ring[(i + 1) % ring.size()]});
  };
  add(polygon.outer);
  for (const Ring& hole : polygon.holes) {
    if (!(SignedArea(hole) < 0.0)) return false;
    add(hole);
  }
  // Rings may touch at vertices, where they could change sides unseen by Meet.
  for (size_t i = 0; i < polygon.holes.size(); ++i) {
    for (size_t k = 0; k < polygon.holes[i].size(); ++k) {
      const Eigen::Vector2d middle = 0.5 * (polygon.holes[i][k] + polygon.holes[i][(k + 1) % polygon.holes[i].size()]);
      if (!RingContains(polygon.outer, middle)) return false;
      for (size_t j = 0; j < polygon.holes.size(); ++j) {
        if (j != i && RingContains(polygon.holes[j], middle)) return false;
      }
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& e, const Side& f) { return std::min(e.a.x(), e.b.x()) < std::min(f.a.x(), f.b.x()); });
  for (size_t i = 0; i < sides.size(); ++i) {
    const double end = std::max(sides[i].a.x(), sides[i].b.x());
    for (size_t j = i + 1; j < sides.size() && std::min(sides[j].a.x(), sides[j].b.x()) <= end; ++j) {
      if (Meet(sides[i], sides[j])) return false;
    }
  }
  return true;
}

}  // namespace

Polygon Simplified(const Polygon& polygon, double tolerance_m) {
  // A large tolerance can make edges cross; smaller ones are tried until they do not.
  constexpr int kTries = 8;
  for (int i = 0; i < kTries; ++i, tolerance_m *= 0.5) {
    Polygon simple;
    simple.outer = SimplifiedRing(polygon.outer, tolerance_m);
    for (const Ring& hole : polygon.holes) simple.holes.push_back(SimplifiedRing(hole, tolerance_m));
    if (IsSimple(simple)) return simple;
  }
  return polygon;
}

}  // namespace skyquilt::buildings
