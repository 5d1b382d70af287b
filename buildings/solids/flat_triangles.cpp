#include "buildings/solids/flat_triangles.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

using FlatTriangle = std::array<uint32_t, 3>;
using IndexRing = std::vector<uint32_t>;

constexpr double kOnLine = 1e-9;    // metres within which a point is on a line
constexpr double kOverlap = 0.001;  // metres that rounding may move edges

class FlatTriangulator {
 public:
  explicit FlatTriangulator(std::span<const Eigen::Vector2d> place) : place_(place) {}

  std::vector<FlatTriangle> Run(std::span<const IndexRing> rings) {
    const std::optional<IndexRing> ring = BridgeHoles(rings);
    if (!ring || !CutEars(*ring)) return {};
    FlipEdges();
    if (Overlap() > kOverlap * PerimeterOf(rings)) return {};
    return std::move(triangle_);
  }

 private:
  // Twice the area of clockwise triangles: rounding leaves little, rings that cross themselves much.
  double Overlap() const {
    double overlap = 0.0;
    for (const auto& [a, b, c] : triangle_) overlap += std::max(0.0, -TwiceArea(a, b, c));
    return overlap;
  }

  double PerimeterOf(std::span<const IndexRing> rings) const {
    double length = 0.0;
    for (const IndexRing& ring : rings) {
      for (size_t i = 0; i < ring.size(); ++i) length += (place_[ring[(i + 1) % ring.size()]] - place_[ring[i]]).norm();
    }
    return length;
  }

  double TwiceArea(uint32_t a, uint32_t b, uint32_t c) const { return Cross2(place_[b] - place_[a], place_[c] - place_[a]); }

  // Whether a place lies in the angle inside the polygon at a point of its ring.
  bool InAngle(const IndexRing& ring, size_t at, const Eigen::Vector2d& place) const {
    const Eigen::Vector2d& tip = place_[ring[at]];
    const Eigen::Vector2d ahead = place_[ring[(at + 1) % ring.size()]] - tip, back = place_[ring[(at + ring.size() - 1) % ring.size()]] - tip;
    const Eigen::Vector2d to = place - tip;
    const bool left_of_ahead = Cross2(ahead, to) > 0.0, right_of_back = Cross2(to, back) > 0.0;
    return Cross2(ahead, back) > 0.0 ? left_of_ahead && right_of_back : left_of_ahead || right_of_back;
  }

  // Whether the edges of a ring leave the way between two of its or other points free.
  bool IsFree(const IndexRing& ring, uint32_t from, uint32_t to) const {
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t a = ring[i], b = ring[(i + 1) % ring.size()];
      if (a != from && a != to && DistanceToSegment(place_[a], place_[from], place_[to]) < kOnLine) return false;
      if (a == from || a == to || b == from || b == to) continue;
      const double of_a = TwiceArea(from, to, a), of_b = TwiceArea(from, to, b);
      const double of_from = TwiceArea(a, b, from), of_to = TwiceArea(a, b, to);
      if ((of_a > 0.0) != (of_b > 0.0) && (of_from > 0.0) != (of_to > 0.0)) return false;
    }
    return true;
  }

  // Makes one ring by ways to the holes and back (Eberly, Triangulation by ear clipping): holes in the order of their easternmost points, from which
  // the outer ring or a hole already reached can always be seen.
  std::optional<IndexRing> BridgeHoles(std::span<const IndexRing> rings) const {
    IndexRing ring = rings.front();
    std::vector<IndexRing> holes(rings.begin() + 1, rings.end());
    const auto before = [&](uint32_t v, uint32_t w) {
      const Eigen::Vector2d &a = place_[v], &b = place_[w];
      return std::tuple(a.x(), a.y(), v) < std::tuple(b.x(), b.y(), w);
    };
    for (IndexRing& hole : holes) std::rotate(hole.begin(), std::max_element(hole.begin(), hole.end(), before), hole.end());
    std::sort(holes.begin(), holes.end(), [&](const IndexRing& a, const IndexRing& b) { return before(b.front(), a.front()); });
    while (!holes.empty()) {
      // Holes that touch what is joined come first: they may lead to others, to which a way would cut the inside in two.
      const auto touching = std::find_if(holes.begin(), holes.end(), [&](const IndexRing& hole) { return JoinTouching(hole, &ring); });
      if (touching == holes.end() && !JoinByWay(holes, &ring)) return std::nullopt;
      holes.erase(touching == holes.end() ? holes.begin() : touching);
    }
    return ring;
  }

  // Joins a hole to the ring where both have a point in common.
  bool JoinTouching(IndexRing hole, IndexRing* ring) const {
    for (size_t k = 0; k < hole.size(); ++k, std::rotate(hole.begin(), hole.begin() + 1, hole.end())) {
      for (size_t i = 0; i < ring->size(); ++i) {
        if ((*ring)[i] != hole.front() || !InAngle(*ring, i, place_[hole[1]])) continue;
        std::rotate(hole.begin(), hole.begin() + 1, hole.end());
        ring->insert(ring->begin() + static_cast<std::ptrdiff_t>(i) + 1, hole.begin(), hole.end());
        return true;
      }
    }
    return false;
  }

  // Joins the first hole by the shortest way from its first point that no ring crosses.
  bool JoinByWay(std::span<const IndexRing> holes, IndexRing* ring) const {
    IndexRing way = holes.front();
    const uint32_t tip = way.front();
    std::vector<size_t> order(ring->size());
    std::iota(order.begin(), order.end(), size_t{0});
    const auto distance = [&](size_t i) { return (place_[(*ring)[i]] - place_[tip]).squaredNorm(); };
    std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return std::pair(distance(i), i) < std::pair(distance(j), j); });
    const auto found = std::find_if(order.begin(), order.end(), [&](size_t i) {
      const uint32_t to = (*ring)[i];
      return InAngle(*ring, i, place_[tip]) && InAngle(way, 0, place_[to]) && IsFree(*ring, to, tip) &&
             std::all_of(holes.begin(), holes.end(), [&](const IndexRing& hole) { return IsFree(hole, to, tip); });
    });
    if (found == order.end()) return false;
    way.push_back(tip);
    way.push_back((*ring)[*found]);
    ring->insert(ring->begin() + static_cast<std::ptrdiff_t>(*found) + 1, way.begin(), way.end());
    return true;
  }

  // Ears are triangles of three points in a row without other points (Meisters 1975).
  bool CutEars(IndexRing ring) {
    size_t start = 0;
    while (ring.size() > 3) {
      std::optional<size_t> ear;
      for (size_t k = 0; k < ring.size() && !ear; ++k) {
        const size_t tip = (start + k) % ring.size();
        if (HeightOfEar(ring, tip) > kOnLine && IsEmpty(ring, tip)) ear = tip;
      }
      if (!ear) ear = FlatEar(ring);
      if (!ear) return false;
      const size_t n = ring.size();
      triangle_.push_back({ring[(*ear + n - 1) % n], ring[*ear], ring[(*ear + 1) % n]});
      ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(*ear));
      start = *ear + 1;  // not beside the last ear, which would make a fan
    }
    triangle_.push_back({ring[0], ring[1], ring[2]});
    return true;
  }

  // Metres of a corner over the line from the point before it to the one after it; negative in notches.
  double HeightOfEar(const IndexRing& ring, size_t tip) const {
    const size_t n = ring.size();
    const uint32_t a = ring[(tip + n - 1) % n], c = ring[(tip + 1) % n];
    return a == c ? -1.0 : TwiceArea(a, ring[tip], c) / (place_[c] - place_[a]).norm();
  }

  // Whether no other point lies in the triangle at a corner or on its border.
  bool IsEmpty(const IndexRing& ring, size_t tip) const {
    const size_t n = ring.size();
    const std::array<uint32_t, 3> ear = {ring[(tip + n - 1) % n], ring[tip], ring[(tip + 1) % n]};
    return std::none_of(ring.begin(), ring.end(), [&](uint32_t x) {
      if (x == ear[0] || x == ear[1] || x == ear[2]) return false;
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = ear[k], b = ear[(k + 1) % 3];
        if (TwiceArea(a, b, x) < -kOnLine * (place_[b] - place_[a]).norm()) return false;
      }
      return true;
    });
  }

  // When there is no ear, points lie on a line: then a triangle without area will do, which FlipEdges turns into another. The middle point must lie
  // between the others.
  std::optional<size_t> FlatEar(const IndexRing& ring) const {
    std::optional<size_t> best;
    double highest = -kOverlap;
    const size_t n = ring.size();
    for (size_t tip = 0; tip < n; ++tip) {
      const Eigen::Vector2d &a = place_[ring[(tip + n - 1) % n]], &b = place_[ring[tip]], &c = place_[ring[(tip + 1) % n]];
      const double height = HeightOfEar(ring, tip);
      if (height <= highest || height > kOverlap || (b - a).dot(c - b) <= 0.0) continue;
      highest = height;
      best = tip;
    }
    return best;
  }

  // Lawson 1977. Edges of the polygon have a triangle on one side only.
  void FlipEdges() {
    const size_t most = 20 * triangle_.size() * triangle_.size() + 20;
    for (size_t flips = 0; flips < most; ++flips) {
      std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<size_t, size_t>>> uses;  // triangle and its corner opposite to the edge
      for (size_t t = 0; t < triangle_.size(); ++t) {
        for (size_t k = 0; k < 3; ++k) uses[std::minmax(triangle_[t][(k + 1) % 3], triangle_[t][(k + 2) % 3])].emplace_back(t, k);
      }
      bool flipped = false;
      std::vector<bool> touched(triangle_.size(), false);
      for (const auto& [edge, pair] : uses) {
        if (pair.size() != 2 || touched[pair[0].first] || touched[pair[1].first]) continue;
        const auto [s, at_s] = pair[0];
        const auto [t, at_t] = pair[1];
        const uint32_t p = triangle_[s][at_s], a = triangle_[s][(at_s + 1) % 3], b = triangle_[s][(at_s + 2) % 3], q = triangle_[t][at_t];
        if (p == q || triangle_[t][(at_t + 1) % 3] != b || !ShouldFlip(p, a, b, q)) continue;
        triangle_[s] = {p, a, q};
        triangle_[t] = {q, b, p};
        touched[s] = touched[t] = flipped = true;
      }
      if (!flipped) return;
    }
  }

  bool ShouldFlip(uint32_t p, uint32_t a, uint32_t b, uint32_t q) const {
    if (!(TwiceArea(p, a, q) > 0.0) || !(TwiceArea(q, b, p) > 0.0)) return false;
    // The angles opposite to the edge exceed 180 degrees together: the sine of their sum is negative. The margin keeps rounding from flipping to and
    // fro.
    const Eigen::Vector2d pa = place_[a] - place_[p], pb = place_[b] - place_[p], qa = place_[a] - place_[q], qb = place_[b] - place_[q];
    const double sine = Cross2(pa, pb) * qa.dot(qb) + pa.dot(pb) * Cross2(qb, qa);
    return sine < -1e-9 * pa.norm() * pb.norm() * qa.norm() * qb.norm();
  }

  std::span<const Eigen::Vector2d> place_;
  std::vector<FlatTriangle> triangle_;
};

}  // namespace

std::vector<std::array<uint32_t, 3>> FlatTriangles(std::span<const Eigen::Vector2d> place, std::span<const std::vector<uint32_t>> rings) {
  if (rings.empty() || rings.front().size() < 3) return {};
  return FlatTriangulator(place).Run(rings);
}

}  // namespace skyquilt::buildings
