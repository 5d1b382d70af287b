#include "buildings/fit/roof_pieces.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::buildings {
namespace {

using Ring = std::vector<Eigen::Vector2d>;

constexpr double kSame = 1e-9;      // planes that differ less are one
constexpr double kLeast_m2 = 1e-9;  // smaller pieces are dropped

struct Plane {
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double offset = 0.0;

  double At(const Eigen::Vector2d& uv) const { return slope.dot(uv) + offset; }
};

// The roof of a part is the lowest of these planes everywhere.
std::vector<Plane> PlanesOf(const Shape& shape, const Part& part) {
  const Eigen::Vector2d low = shape.MinOf(part, false), high = shape.MaxOf(part, false);
  const bool hip = part.roof == RoofKind::kHip;
  if (!hip && part.roof != RoofKind::kGable) return {{Eigen::Vector2d::Zero(), part.eave_z}};
  const Eigen::Vector2d half = 0.5 * (high - low);
  const int across = part.along_u ? 1 : 0;
  const double reach = hip ? half.minCoeff() : half[across];
  const double rise = reach > 0.0 ? (part.ridge_z - part.eave_z) / reach : 0.0;
  std::vector<Plane> planes;
  for (const int axis : {0, 1}) {
    if (!hip && axis != across) continue;
    const Eigen::Vector2d up = Eigen::Vector2d::Unit(axis) * rise;
    planes.push_back({up, part.eave_z - rise * low[axis]});
    planes.push_back({-up, part.eave_z + rise * high[axis]});
  }
  return planes;
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

double AreaOf(const Ring& ring) {
  double twice = 0.0;
  for (size_t i = 1; i + 1 < ring.size(); ++i) twice += Cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  return 0.5 * twice;
}

// Of a convex ring, for the integral of a plane over it.
Eigen::Vector2d MiddleOf(const Ring& ring) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double twice = 0.0;
  for (size_t i = 1; i + 1 < ring.size(); ++i) {
    const double area = Cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
    sum += area * (ring[0] + ring[i] + ring[i + 1]) / 3.0;
    twice += area;
  }
  return sum / twice;
}

// What is left of a convex ring where the function is not negative (Sutherland and Hodgman 1974).
Ring Clipped(const Ring& ring, const Plane& function) {
  Ring kept;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    const double at_a = function.At(a), at_b = function.At(b);
    if (at_a >= 0.0) kept.push_back(a);
    if ((at_a >= 0.0) != (at_b >= 0.0)) kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
  }
  return kept;
}

Plane Difference(const Plane& a, const Plane& b) {
  return {a.slope - b.slope, a.offset - b.offset};
}

bool IsZero(const Plane& function, const Ring& ring) {
  return std::all_of(ring.begin(), ring.end(), [&](const Eigen::Vector2d& uv) { return std::abs(function.At(uv)) < kSame; });
}

// Where planes[i] is the lowest of the planes; of equal planes the first.
Ring LowestOf(const std::vector<Plane>& planes, size_t i, Ring ring) {
  for (size_t k = 0; k < planes.size() && ring.size() >= 3; ++k) {
    if (k == i) continue;
    const Plane difference = Difference(planes[k], planes[i]);
    if (IsZero(difference, ring)) {
      if (k < i) ring.clear();
    } else {
      ring = Clipped(ring, difference);
    }
  }
  return ring;
}

// The envelope over one rectangle that no wall line or end of a roof crosses.
class CellEnvelope {
 public:
  CellEnvelope(std::vector<std::vector<Plane>> roofs, std::vector<RoofPiece>* pieces) : roofs_(std::move(roofs)), pieces_(pieces) {}

  void Add(const Ring& cell) {
    for (size_t roof = 0; roof < roofs_.size(); ++roof) {
      for (size_t i = 0; i < roofs_[roof].size(); ++i) AddAbove(0, roof, roofs_[roof][i], LowestOf(roofs_[roof], i, cell));
    }
  }

 private:
  // Adds what of the ring, where `plane` is the roof `own`, lies above all roofs from `other` on.
  void AddAbove(size_t other, size_t own, const Plane& plane, const Ring& ring) {
    if (ring.size() < 3 || AreaOf(ring) < kLeast_m2) return;
    if (other == own) ++other;
    if (other >= roofs_.size()) {
      pieces_->push_back({ring, plane.slope, plane.offset});
      return;
    }
    for (size_t k = 0; k < roofs_[other].size(); ++k) {
      const Ring below = LowestOf(roofs_[other], k, ring);
      if (below.size() < 3) continue;
      const Plane difference = Difference(plane, roofs_[other][k]);
      if (IsZero(difference, below)) {
        if (own < other) AddAbove(other + 1, own, plane, below);
      } else {
        AddAbove(other + 1, own, plane, Clipped(below, difference));
      }
    }
  }

  std::vector<std::vector<Plane>> roofs_;
  std::vector<RoofPiece>* pieces_;
};

std::vector<double> Breaks(const Shape& shape, int axis) {
  std::vector<double> breaks;
  for (const Part& part : shape.parts) {
    for (const bool roof : {false, true}) {
      breaks.push_back(shape.MinOf(part, roof)[axis]);
      breaks.push_back(shape.MaxOf(part, roof)[axis]);
    }
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

bool Covers(const Shape& shape, const Part& part, bool roof, const Eigen::Vector2d& uv) {
  return ((uv - shape.MinOf(part, roof)).array() >= 0.0).all() && ((shape.MaxOf(part, roof) - uv).array() >= 0.0).all();
}

}  // namespace

std::vector<RoofPiece> RoofPieces(const Shape& shape) {
  const std::vector<double> u = Breaks(shape, 0), v = Breaks(shape, 1);
  std::vector<RoofPiece> pieces;
  for (size_t i = 0; i + 1 < u.size(); ++i) {
    for (size_t k = 0; k + 1 < v.size(); ++k) {
      const Eigen::Vector2d middle(0.5 * (u[i] + u[i + 1]), 0.5 * (v[k] + v[k + 1]));
      bool inside = false;
      std::vector<std::vector<Plane>> roofs;
      for (const Part& part : shape.parts) {
        inside = inside || Covers(shape, part, false, middle);
        if (Covers(shape, part, false, middle) || Covers(shape, part, true, middle)) roofs.push_back(PlanesOf(shape, part));
      }
      if (!inside) continue;
      CellEnvelope(std::move(roofs), &pieces).Add({{u[i], v[k]}, {u[i + 1], v[k]}, {u[i + 1], v[k + 1]}, {u[i], v[k + 1]}});
    }
  }
  return pieces;
}

RoofTotals TotalsOf(const Shape& shape) {
  RoofTotals totals;
  for (const RoofPiece& piece : RoofPieces(shape)) {
    const double area = AreaOf(piece.outline);
    totals.plan_m2 += area;
    totals.sloped_m2 += area * std::sqrt(1.0 + piece.slope.squaredNorm());
    totals.volume_m3 += area * (piece.slope.dot(MiddleOf(piece.outline)) + piece.offset - shape.ground_z);
  }
  return totals;
}

}  // namespace skyquilt::buildings
