#include "surface/mesh/hole_patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

constexpr size_t kNoTriangle = static_cast<size_t>(-1);

// An edge with the triangle on each side; the second is kNoTriangle at the border.
struct PatchEdge {
  uint32_t low = 0, high = 0;
  std::array<size_t, 2> triangle = {kNoTriangle, kNoTriangle};
};

class PatchBuilder {
 public:
  PatchBuilder(std::span<const Eigen::Vector3d> border, std::vector<Triangle> triangles)
      : n_border_(border.size()), point_(border.begin(), border.end()), triangle_(std::move(triangles)) {}

  HolePatch Make(double spacing_m) {
    FlipEdges();
    if (spacing_m > 0.0) HalveEdges(spacing_m);
    PutPointsIntoRest();
    Relax();
    return {{point_.begin() + static_cast<std::ptrdiff_t>(n_border_), point_.end()}, std::move(triangle_)};
  }

 private:
  Eigen::Vector2d At(uint32_t v) const { return point_[v].head<2>(); }

  // Sorted by their vertices, only those with triangles on both sides.
  std::vector<PatchEdge> InnerEdges() const {
    std::vector<PatchEdge> uses;
    for (size_t t = 0; t < triangle_.size(); ++t) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t a = triangle_[t][k], b = triangle_[t][(k + 1) % 3];
        uses.push_back({std::min(a, b), std::max(a, b), {t, kNoTriangle}});
      }
    }
    const auto key = [](const PatchEdge& edge) { return std::array<size_t, 3>{edge.low, edge.high, edge.triangle[0]}; };
    std::sort(uses.begin(), uses.end(), [&](const PatchEdge& a, const PatchEdge& b) { return key(a) < key(b); });
    std::vector<PatchEdge> inner;
    for (size_t i = 0; i + 1 < uses.size(); ++i) {
      if (uses[i].low == uses[i + 1].low && uses[i].high == uses[i + 1].high)
        inner.push_back({uses[i].low, uses[i].high, {uses[i].triangle[0], uses[i + 1].triangle[0]}});
    }
    return inner;
  }

  // The triangle's vertices from the one that is not on the edge, counter-clockwise.
  Triangle FromOpposite(size_t t, const PatchEdge& edge) const {
    Triangle turned = triangle_[t];
    while (turned[0] == edge.low || turned[0] == edge.high) std::rotate(turned.begin(), turned.begin() + 1, turned.end());
    return turned;
  }

  // Makes the triangulation Delaunay as seen from above (Lawson 1977), up to a number of rounds; its triangles are the least narrow ones.
  void FlipEdges() {
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<uint8_t> touched(triangle_.size(), 0);
      bool flipped = false;
      for (const PatchEdge& edge : InnerEdges()) {
        const auto [s, t] = edge.triangle;
        if (touched[s] != 0 || touched[t] != 0) continue;
        const auto [p, a, b] = FromOpposite(s, edge);
        const uint32_t q = FromOpposite(t, edge)[0];
        if (!(DoubleAreaFromAbove(At(p), At(a), At(q)) > 0.0) || !(DoubleAreaFromAbove(At(q), At(b), At(p)) > 0.0)) continue;
        // Not Delaunay when the angles opposite to the edge exceed 180 degrees together; the margin keeps rounding from flipping to and fro.
        const Eigen::Vector2d pa = At(a) - At(p), pb = At(b) - At(p), qa = At(a) - At(q), qb = At(b) - At(q);
        const double cos_p = pa.dot(pb) / (pa.norm() * pb.norm()), cos_q = qa.dot(qb) / (qa.norm() * qb.norm());
        if (!(std::acos(std::clamp(cos_p, -1.0, 1.0)) + std::acos(std::clamp(cos_q, -1.0, 1.0)) > std::numbers::pi + 1e-6)) continue;
        triangle_[s] = {p, a, q};
        triangle_[t] = {q, b, p};
        touched[s] = touched[t] = 1;
        flipped = true;
      }
      if (!flipped) return;
    }
  }

  void HalveEdges(double spacing_m) {
    double area = 0.0;
    for (const auto& [a, b, c] : triangle_) area += 0.5 * DoubleAreaFromAbove(At(a), At(b), At(c));
    constexpr double kMostPoints = 1e5;
    const size_t limit =
        n_border_ + static_cast<size_t>(std::min(kMostPoints, static_cast<double>(n_border_) + 4.0 * area / (spacing_m * spacing_m)));
    constexpr int kRounds = 40;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<PatchEdge> edges = InnerEdges();
      const auto length2 = [&](const PatchEdge& edge) { return (At(edge.low) - At(edge.high)).squaredNorm(); };
      std::erase_if(edges, [&](const PatchEdge& edge) { return !(length2(edge) > spacing_m * spacing_m); });
      std::stable_sort(edges.begin(), edges.end(), [&](const PatchEdge& a, const PatchEdge& b) { return length2(a) > length2(b); });
      std::vector<uint8_t> touched(triangle_.size(), 0);
      bool halved = false;
      for (const PatchEdge& edge : edges) {
        const auto [s, t] = edge.triangle;
        if (touched[s] != 0 || touched[t] != 0 || point_.size() >= limit) continue;
        const auto [p, a, b] = FromOpposite(s, edge);
        const uint32_t q = FromOpposite(t, edge)[0], m = static_cast<uint32_t>(point_.size());
        point_.push_back(0.5 * (point_[a] + point_[b]));
        triangle_[s] = {p, a, m};
        triangle_[t] = {q, b, m};
        triangle_.push_back({p, m, b});
        triangle_.push_back({q, m, a});
        touched[s] = touched[t] = 1;
        halved = true;
      }
      if (!halved) return;
      FlipEdges();
    }
  }

  // Splits triangles of border vertices alone at their middles.
  void PutPointsIntoRest() {
    const size_t n = triangle_.size();
    for (size_t t = 0; t < n; ++t) {
      const auto [a, b, c] = triangle_[t];
      if (std::max({a, b, c}) >= n_border_) continue;
      const uint32_t m = static_cast<uint32_t>(point_.size());
      point_.push_back((point_[a] + point_[b] + point_[c]) / 3.0);
      triangle_[t] = {a, b, m};
      triangle_.push_back({b, c, m});
      triangle_.push_back({c, a, m});
    }
  }

  // Heights of the new points: means of their neighbours, with mean value weights (Floater 2003), which are positive and keep planes as they are.
  void Relax() {
    std::vector<std::vector<std::pair<uint32_t, double>>> weights(point_.size());
    for (const Triangle& t : triangle_) {
      for (size_t k = 0; k < 3; ++k) {
        const uint32_t v = t[k], a = t[(k + 1) % 3], b = t[(k + 2) % 3];
        const Eigen::Vector2d to_a = At(a) - At(v), to_b = At(b) - At(v);
        // Tangent of half the angle at v.
        const double tangent = DoubleAreaFromAbove(At(v), At(a), At(b)) / (to_a.norm() * to_b.norm() + to_a.dot(to_b));
        weights[v].emplace_back(a, tangent / to_a.norm());
        weights[v].emplace_back(b, tangent / to_b.norm());
      }
    }
    constexpr int kRounds = 500;
    constexpr double kStillMoving = 1e-5;  // metres
    for (int round = 0; round < kRounds; ++round) {
      double largest = 0.0;
      for (size_t v = n_border_; v < point_.size(); ++v) {
        double sum = 0.0, total = 0.0;
        for (const auto& [neighbour, weight] : weights[v]) {
          sum += weight * point_[neighbour].z();
          total += weight;
        }
        const double mean = sum / total;
        if (!std::isfinite(mean)) continue;  // triangles without area
        largest = std::max(largest, std::abs(mean - point_[v].z()));
        point_[v].z() = mean;
      }
      if (largest < kStillMoving) return;
    }
  }

  size_t n_border_;
  std::vector<Eigen::Vector3d> point_;
  std::vector<Triangle> triangle_;
};

}  // namespace

std::optional<HolePatch> MakeHolePatch(std::span<const Eigen::Vector3d> border, double spacing_m) {
  std::optional<std::vector<Triangle>> ears = CutEars(border);
  if (!ears) return std::nullopt;
  return PatchBuilder(border, std::move(*ears)).Make(spacing_m);
}

}  // namespace skyquilt::surface
