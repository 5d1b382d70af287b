#include "buildings/solids/roof_walls.h"

#include <algorithm>
#include <optional>

#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

constexpr double kStraight = 0.003;  // metres from one line within which walls are of one plane

// Wall above one edge of the map; the roof is on the left of the way from a to b.
struct WallPiece {
  uint32_t a = 0, b = 0;
  int low_a = 0, high_a = 0, low_b = 0, high_b = 0;  // levels
};

class WallMaker {
 public:
  explicit WallMaker(const RoofMap& roof) : roof_(roof), starts_(roof.map().Vertices()), uses_(roof.map().Vertices()) {}

  std::vector<Wall> Make() {
    FindPieces();
    std::vector<std::optional<size_t>> next(piece_.size());
    std::vector<bool> follows(piece_.size(), false);
    for (size_t p = 0; p < piece_.size(); ++p) {
      for (const size_t q : starts_[piece_[p].b]) {
        if (!GoesOn(p, q)) continue;
        next[p] = q;
        follows[q] = true;
      }
    }
    std::vector<Wall> walls;
    for (size_t first = 0; first < piece_.size(); ++first) {
      if (follows[first]) continue;
      std::vector<size_t> chain = {first};
      while (const std::optional<size_t> q = next[chain.back()]) {
        // Bends too small to be seen from one piece to the next can add up.
        if (!IsStraight(chain, *q)) {
          walls.push_back(WallOf(chain));
          chain.clear();
        }
        chain.push_back(*q);
      }
      walls.push_back(WallOf(chain));
    }
    return walls;
  }

 private:
  const Eigen::Vector2d& At(uint32_t v) const { return roof_.map().Vertex(v); }

  void FindPieces() {
    const PlanarMap& map = roof_.map();
    for (uint32_t v = 0; v < map.Vertices(); ++v) uses_[v].assign(static_cast<size_t>(std::max(roof_.Levels(v), 1)), 0);
    for (uint32_t h = 0; h < map.HalfEdges(); ++h) {
      const int left = roof_.LabelOf(h), right = roof_.LabelOf(PlanarMap::Twin(h));
      if (left == right) continue;
      const uint32_t a = map.From(h), b = map.To(h);
      const WallPiece piece = {a, b, roof_.LevelOf(a, right), roof_.LevelOf(a, left), roof_.LevelOf(b, right), roof_.LevelOf(b, left)};
      if (piece.high_a + piece.high_b <= piece.low_a + piece.low_b) continue;
      starts_[a].push_back(piece_.size());
      piece_.push_back(piece);
      for (int level = piece.low_a; level < piece.high_a; ++level) ++uses_[a][static_cast<size_t>(level)];
      for (int level = piece.low_b; level < piece.high_b; ++level) ++uses_[b][static_cast<size_t>(level)];
    }
  }

  // Whether piece q lies in the plane of p, beginning where p ends, and both share an upright edge that no other wall uses.
  bool GoesOn(size_t p, size_t q) const {
    const WallPiece &one = piece_[p], &two = piece_[q];
    if ((At(one.b) - At(one.a)).dot(At(two.b) - At(two.a)) <= 0.0 || !IsStraight({p}, q)) return false;
    const int low = std::max(one.low_b, two.low_a), high = std::min(one.high_b, two.high_a);
    if (low >= high) return false;
    const std::vector<int>& uses = uses_[one.b];
    return std::all_of(uses.begin() + low, uses.begin() + high, [](int n) { return n == 2; });
  }

  bool IsStraight(const std::vector<size_t>& chain, size_t q) const {
    const Eigen::Vector2d &from = At(piece_[chain.front()].a), &to = At(piece_[q].b);
    return std::all_of(chain.begin(), chain.end(), [&](size_t p) { return DistanceToSegment(At(piece_[p].b), from, to) <= kStraight; });
  }

  // Along the lower edges and back along the upper ones, up and down the columns between.
  Wall WallOf(const std::vector<size_t>& chain) const {
    Wall wall;
    const auto go = [&](uint32_t v, int from, int to) {
      for (int level = from;; level += from < to ? 1 : -1) {
        if (wall.empty() || wall.back() != WallCorner{v, level}) wall.push_back({v, level});
        if (level == to) return;
      }
    };
    const WallPiece &first = piece_[chain.front()], &last = piece_[chain.back()];
    wall.push_back({first.a, first.low_a});
    for (size_t i = 0; i + 1 < chain.size(); ++i) go(piece_[chain[i]].b, piece_[chain[i]].low_b, piece_[chain[i + 1]].low_a);
    go(last.b, last.low_b, last.high_b);
    for (size_t i = chain.size() - 1; i > 0; --i) go(piece_[chain[i]].a, piece_[chain[i]].high_a, piece_[chain[i - 1]].high_b);
    go(first.a, first.high_a, first.low_a);
    if (wall.size() > 1 && wall.back() == wall.front()) wall.pop_back();
    return wall;
  }

  const RoofMap& roof_;
  std::vector<WallPiece> piece_;
  std::vector<std::vector<size_t>> starts_;  // pieces that begin at a vertex
  std::vector<std::vector<int>> uses_;       // of the upright edges from each level of a column to the next
};

}  // namespace

std::vector<Wall> WallsOf(const RoofMap& roof) {
  return WallMaker(roof).Make();
}

}  // namespace skyquilt::buildings
