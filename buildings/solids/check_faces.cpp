// Rings and planes of single faces.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "buildings/geometry/rings.h"
#include "buildings/solids/face_plane.h"
#include "buildings/solids/solid_checks.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSamePoint = 0.001;    // metres
constexpr double kOffPlane = 0.01;      // metres
constexpr double kTurnedNormal = 20.0;  // degrees

struct FlatEdge {
  Eigen::Vector2d a, b;
  uint32_t from = 0, to = 0;
  size_t ring = 0, index = 0;
};

bool OnSegment(const Eigen::Vector2d& p, const FlatEdge& edge) {
  return DistanceToSegment(p, edge.a, edge.b) < 1e-9;
}

// Whether edges have more in common than a vertex of both.
bool EdgesMeet(const FlatEdge& e, const FlatEdge& f) {
  const Eigen::Vector2d along_e = e.b - e.a, along_f = f.b - f.a;
  const bool shared_end = e.to == f.from || e.from == f.to, shared_same = e.from == f.from || e.to == f.to;
  if (shared_end || shared_same) {
    // Edges from one vertex overlap when they run the same way.
    const double sense = shared_same ? 1.0 : -1.0;
    return std::abs(Cross2(along_e, along_f)) <= 1e-9 * along_e.norm() * along_f.norm() && sense * along_e.dot(along_f) > 0.0;
  }
  if (OnSegment(e.a, f) || OnSegment(e.b, f) || OnSegment(f.a, e) || OnSegment(f.b, e)) return true;
  const double f_a = Cross2(along_e, f.a - e.a), f_b = Cross2(along_e, f.b - e.a);
  const double e_a = Cross2(along_f, e.a - f.a), e_b = Cross2(along_f, e.b - f.a);
  return (f_a > 0.0) != (f_b > 0.0) && (e_a > 0.0) != (e_b > 0.0);
}

class FaceChecker {
 public:
  FaceChecker(const Solid& solid, size_t f, std::vector<SolidProblem>* problems)
      : solid_(solid), face_(solid.face[f]), name_("Face " + std::to_string(f)), plane_(PlaneOf(solid, solid.face[f])), problems_(problems) {
    rings_.push_back(&face_.outer);
    for (const std::vector<uint32_t>& hole : face_.holes) rings_.push_back(&hole);
    for (const std::vector<uint32_t>* ring : rings_) {
      flat_.emplace_back();
      for (const uint32_t v : *ring) flat_.back().push_back(plane_.Project(solid_.vertex[v]));
    }
  }

  // Whether the rings allow to look at the plane.
  bool CheckRings() {
    const size_t before = problems_->size();
    for (const std::vector<uint32_t>* ring : rings_) CheckPoints(*ring);
    if (problems_->size() > before) return false;
    CheckCrossings();
    if (problems_->size() > before) return false;
    CheckHoles();
    return problems_->size() == before;
  }

  void CheckPlane(std::span<const std::array<uint32_t, 3>> triangles) {
    for (const std::vector<uint32_t>* ring : rings_) {
      for (const uint32_t v : *ring) {
        if (std::abs(plane_.HeightAbove(solid_.vertex[v])) <= kOffPlane) continue;
        return Add(203, " is not planar: vertex " + std::to_string(v) + " lies more than 1 cm off its plane.");
      }
    }
    if (triangles.empty()) return Add(104, " cannot be triangulated: its border crosses itself or has no area.");
    const double least_cosine = std::cos(kTurnedNormal * std::numbers::pi / 180.0);
    for (const auto& [a, b, c] : triangles) {
      const Eigen::Vector3d normal = (solid_.vertex[b] - solid_.vertex[a]).cross(solid_.vertex[c] - solid_.vertex[a]);
      if (normal.dot(plane_.normal) >= least_cosine * normal.norm()) continue;
      return Add(204, " is folded: a triangle of it at vertex " + std::to_string(a) + " is turned by more than 20 degrees.");
    }
  }

 private:
  void Add(int code, const std::string& what) { problems_->push_back({code, name_ + what}); }

  void CheckPoints(const std::vector<uint32_t>& ring) {
    if (ring.size() < 3) return Add(101, " has a ring of fewer than three points.");
    for (size_t i = 0; i < ring.size(); ++i) {
      const uint32_t a = ring[i], b = ring[(i + 1) % ring.size()];
      if (a == b || (solid_.vertex[b] - solid_.vertex[a]).norm() < kSamePoint * (1.0 - 1e-6))
        return Add(102, " has the same point twice in a row, at vertex " + std::to_string(a) + ".");
    }
    std::vector<uint32_t> sorted = ring;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
      Add(104, " has a ring that passes vertex " + std::to_string(*twice) + " twice.");
  }

  void CheckCrossings() {
    std::vector<FlatEdge> edges;
    for (size_t r = 0; r < rings_.size(); ++r) {
      const size_t n = flat_[r].size();
      for (size_t i = 0; i < n; ++i) edges.push_back({flat_[r][i], flat_[r][(i + 1) % n], (*rings_[r])[i], (*rings_[r])[(i + 1) % n], r, i});
    }
    std::sort(edges.begin(), edges.end(),
              [](const FlatEdge& e, const FlatEdge& f) { return std::min(e.a.x(), e.b.x()) < std::min(f.a.x(), f.b.x()); });
    for (size_t i = 0; i < edges.size(); ++i) {
      const double end = std::max(edges[i].a.x(), edges[i].b.x()) + 1e-9;
      for (size_t j = i + 1; j < edges.size() && std::min(edges[j].a.x(), edges[j].b.x()) <= end; ++j) {
        if (!EdgesMeet(edges[i], edges[j])) continue;
        const std::string where = " at vertices " + std::to_string(edges[i].from) + " and " + std::to_string(edges[j].from) + ".";
        return edges[i].ring == edges[j].ring ? Add(104, " has a ring that crosses itself" + where) : Add(201, " has rings that cross" + where);
      }
    }
  }

  // Of rings that do not cross.
  void CheckHoles() {
    for (size_t r = 1; r < flat_.size(); ++r) {
      if (SignedArea(flat_[r]) >= 0.0) return Add(208, " has a hole that runs the same way as the outer ring.");
      const Eigen::Vector2d middle = 0.5 * (flat_[r][0] + flat_[r][1]);  // vertices may touch other rings
      if (!RingContains(flat_[0], middle)) return Add(206, " has a hole outside its outer ring.");
      for (size_t s = 1; s < flat_.size(); ++s) {
        if (s != r && RingContains(flat_[s], middle)) return Add(207, " has a hole inside another hole.");
      }
    }
  }

  const Solid& solid_;
  const Face& face_;
  std::string name_;
  FacePlane plane_;
  std::vector<SolidProblem>* problems_;
  std::vector<const std::vector<uint32_t>*> rings_;
  std::vector<Ring> flat_;
};

}  // namespace

std::vector<SolidProblem> CheckFaces(const Solid& solid, const SolidTriangles& triangles) {
  std::vector<SolidProblem> problems;
  size_t begin = 0;
  for (size_t f = 0; f < solid.face.size(); ++f) {
    size_t end = begin;
    while (end < triangles.face.size() && triangles.face[end] == f) ++end;
    FaceChecker checker(solid, f, &problems);
    if (checker.CheckRings()) checker.CheckPlane(std::span(triangles.triangle).subspan(begin, end - begin));
    begin = end;
  }
  return problems;
}

}  // namespace skyquilt::buildings
