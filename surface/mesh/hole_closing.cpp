#include "surface/mesh/hole_closing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/base/random.h"
#include "surface/mesh/mesh_tools.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

constexpr uint32_t kNoHole = std::numeric_limits<uint32_t>::max();

bool IsInside(const Eigen::Vector2d& x, const std::vector<Eigen::Vector3d>& polygon) {
  bool inside = false;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    if ((a.y() > x.y()) == (b.y() > x.y())) continue;
    const double side = DoubleAreaFromAbove(a.head<2>(), b.head<2>(), x);
    if ((side > 0.0) == (b.y() > a.y())) inside = !inside;
  }
  return inside;
}

bool Crosses(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const auto apart = [](double s, double t) { return (s < 0.0 && t > 0.0) || (s > 0.0 && t < 0.0); };
  return apart(DoubleAreaFromAbove(a, b, c), DoubleAreaFromAbove(a, b, d)) && apart(DoubleAreaFromAbove(c, d, a), DoubleAreaFromAbove(c, d, b));
}

class HoleBlocker {
 public:
  HoleBlocker(const Mesh& mesh, std::vector<Hole>* holes) : mesh_(mesh), holes_(*holes), hole_of_(mesh.position.size(), kNoHole) {
    double sum = 0.0;
    for (const Hole& hole : holes_) sum += (hole.high - hole.low).head<2>().maxCoeff();
    cell_m_ = std::max(sum / static_cast<double>(std::max<size_t>(holes_.size(), 1)), 0.01);
    for (uint32_t i = 0; i < holes_.size(); ++i) {
      for (const uint32_t v : holes_[i].vertex) hole_of_[v] = i;
      const int64_t x1 = CellOf(holes_[i].high.x()), y1 = CellOf(holes_[i].high.y());
      for (int64_t y = CellOf(holes_[i].low.y()); y <= y1; ++y) {
        for (int64_t x = CellOf(holes_[i].low.x()); x <= x1; ++x) in_cell_[CellKey(x, y)].push_back(i);
      }
    }
  }

  // Marks the holes that have a triangle of the mesh inside.
  void Run() {
    for (const Triangle& t : mesh_.triangle) {
      const Eigen::Vector3d &a = mesh_.position[t[0]], &b = mesh_.position[t[1]], &c = mesh_.position[t[2]];
      if (!a.allFinite() || !b.allFinite() || !c.allFinite()) continue;
      const Eigen::Vector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      const int64_t x0 = CellOf(low.x()), x1 = CellOf(high.x()), y0 = CellOf(low.y()), y1 = CellOf(high.y());
      const auto visit = [&](uint32_t i) {
        Hole& hole = holes_[i];
        if (hole.blocked || (low.array() > hole.high.array()).any() || (high.array() < hole.low.array()).any()) return;
        hole.blocked = Overlaps(t, i);
      };
      if (static_cast<double>(x1 - x0 + 1) * static_cast<double>(y1 - y0 + 1) > static_cast<double>(holes_.size())) {
        for (uint32_t i = 0; i < holes_.size(); ++i) visit(i);
        continue;
      }
      for (int64_t y = y0; y <= y1; ++y) {
        for (int64_t x = x0; x <= x1; ++x) {
          const auto found = in_cell_.find(CellKey(x, y));
          if (found == in_cell_.end()) continue;
          for (const uint32_t i : found->second) visit(i);
        }
      }
    }
  }

 private:
  int64_t CellOf(double coordinate_m) const {
    constexpr double kLargest = 1e15;
    return static_cast<int64_t>(std::clamp(std::floor(coordinate_m / cell_m_), -kLargest, kLargest));
  }
  // Different cells may share a key; boxes are compared anyway.
  static uint64_t CellKey(int64_t x, int64_t y) { return base::MixBits(static_cast<uint64_t>(x)) + static_cast<uint64_t>(y); }

  // Whether the triangle covers a part of the hole seen along its normal. The triangles along the border touch it without that.
  bool Overlaps(const Triangle& t, uint32_t index) const {
    const Hole& hole = holes_[index];
    const std::array<Eigen::Vector3d, 3> corner = {hole.Turned(mesh_.position[t[0]]), hole.Turned(mesh_.position[t[1]]),
                                                   hole.Turned(mesh_.position[t[2]])};
    const auto at = [&](size_t k) -> Eigen::Vector2d { return corner[k % 3].head<2>(); };
    const auto [lowest, highest] = std::minmax({corner[0].z(), corner[1].z(), corner[2].z()});
    if (highest < hole.lowest_m || lowest > hole.highest_m) return false;
    if (IsInside((at(0) + at(1) + at(2)) / 3.0, hole.position)) return true;
    for (size_t k = 0; k < 3; ++k) {
      if (hole_of_[t[k]] != index && IsInside(at(k), hole.position)) return true;
    }
    for (size_t i = 0; i < hole.vertex.size(); ++i) {
      const Eigen::Vector2d x = hole.position[i].head<2>(), y = hole.position[(i + 1) % hole.position.size()].head<2>();
      const double s0 = DoubleAreaFromAbove(at(0), at(1), x), s1 = DoubleAreaFromAbove(at(1), at(2), x), s2 = DoubleAreaFromAbove(at(2), at(0), x);
      if ((s0 > 0.0 && s1 > 0.0 && s2 > 0.0) || (s0 < 0.0 && s1 < 0.0 && s2 < 0.0)) return true;
      for (size_t k = 0; k < 3; ++k) {
        if (Crosses(x, y, at(k), at(k + 1))) return true;
      }
    }
    return false;
  }

  const Mesh& mesh_;
  std::vector<Hole>& holes_;
  std::vector<uint32_t> hole_of_;  // per vertex of the mesh: the hole on whose border it is
  double cell_m_ = 1.0;
  std::unordered_map<uint64_t, std::vector<uint32_t>> in_cell_;  // holes whose box meets the cell
};

// Whether an edge of the patch between vertices of the border is an edge of the mesh already; together they would have too many triangles.
bool DoublesAnEdge(const HolePatch& patch, const Hole& hole, const std::vector<EdgeUse>& uses) {
  const size_t n = hole.vertex.size();
  for (const Triangle& t : patch.triangle) {
    for (size_t k = 0; k < 3; ++k) {
      const size_t a = t[k], b = t[(k + 1) % 3];
      if (a < n && b < n && b != (a + 1) % n && HasEdge(uses, hole.vertex[a], hole.vertex[b])) return true;
    }
  }
  return false;
}

// Returns the area of the patch.
double AddPatch(const HolePatch& patch, const Hole& hole, uint64_t* next_key, Mesh* mesh) {
  const size_t first = mesh->position.size();
  for (const Eigen::Vector3d& x : patch.inner) {
    mesh->position.push_back(hole.TurnedBack(x));
    mesh->key.push_back(*next_key);
    mesh->views.push_back(0);
    mesh->filled.push_back(1);
    *next_key += 2 * kFilledKeyBit;
  }
  double area = 0.0;
  for (const Triangle& t : patch.triangle) {
    Triangle own = t;
    for (uint32_t& v : own) v = v < hole.vertex.size() ? hole.vertex[v] : static_cast<uint32_t>(first + v - hole.vertex.size());
    mesh->triangle.push_back(own);
    area += 0.5 * DoubleAreaNormal(mesh->position[own[0]], mesh->position[own[1]], mesh->position[own[2]]).norm();
  }
  return area;
}

}  // namespace

uint64_t NextFilledKey(const Mesh& mesh) {
  uint64_t next = kFilledKeyBit;
  for (const uint64_t key : mesh.key) {
    if ((key & kFilledKeyBit) != 0) next = std::max(next, (key | (2 * kFilledKeyBit - 1)) + 1 + kFilledKeyBit);
  }
  return next;
}

double CloseHoles(std::vector<Hole> holes, const std::vector<EdgeUse>& uses, double spacing_m, const IsOpenThere& is_open, Mesh* mesh) {
  if (holes.empty()) return 0.0;
  HoleBlocker(*mesh, &holes).Run();
  uint64_t next_key = NextFilledKey(*mesh);
  double area = 0.0;
  for (const Hole& hole : holes) {
    if (hole.blocked) continue;
    const std::optional<HolePatch> patch = MakeHolePatch(hole.position, spacing_m);
    if (!patch || DoublesAnEdge(*patch, hole, uses)) continue;
    const auto is_open_at = [&](const Eigen::Vector3d& x) { return is_open(hole.TurnedBack(x), hole.Normal()); };
    if (is_open && std::any_of(patch->inner.begin(), patch->inner.end(), is_open_at)) continue;
    area += AddPatch(*patch, hole, &next_key, mesh);
  }
  return area;
}

}  // namespace skyquilt::surface
