#include "buildings/classes/model_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "buildings/classes/solid_edges.h"

namespace skyquilt::buildings {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSharp_rad = 20.0 * kDegree;
constexpr double kLevel_rad = 5.7 * kDegree;  // flatter roofs have no overhang

bool MeetSharply(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.dot(b) < std::cos(kSharp_rad);
}

// Adds a direction unless one like it is there.
void AddDirection(const Eigen::Vector3d& direction, std::vector<Eigen::Vector3d>* directions) {
  for (const Eigen::Vector3d& old : *directions)
    if (!MeetSharply(old, direction)) return;
  directions->push_back(direction);
}

// A place at the eaves or at the end of a gable, and how the overhang continues there.
struct RimVertex {
  std::vector<Eigen::Vector3d> walls;  // different normals of the walls below
  std::vector<Eigen::Vector3d> roofs;  // different normals of the roofs
  Eigen::Vector3d plane_normal;        // of one of the roofs
};

// Moves a corner so that it is `overhang` in front of all its walls, in plan.
Eigen::Vector2d Outwards(const RimVertex& rim, double overhang) {
  const Eigen::Vector2d first = rim.walls[0].head<2>();
  if (rim.walls.size() < 2) return overhang * first;
  const Eigen::Vector2d second = rim.walls[1].head<2>();
  const double turn = first.x() * second.y() - first.y() * second.x();
  // Walls back to back have no common corner.
  if (std::abs(turn) < std::sin(kSharp_rad)) return overhang * first;
  Eigen::Vector2d move(overhang * (second.y() - first.y()) / turn, overhang * (first.x() - second.x()) / turn);
  const double longest = 3.0 * overhang;
  if (move.norm() > longest) move *= longest / move.norm();
  return move;
}

Eigen::Vector3d OnPlane(const Eigen::Vector3d& from, const Eigen::Vector2d& move, const Eigen::Vector3d& normal) {
  return {from.x() + move.x(), from.y() + move.y(), from.z() - normal.head<2>().dot(move) / normal.z()};
}

class PartsMaker {
 public:
  explicit PartsMaker(const Building& building) : solid_(building.lod22), overhang_m_(building.overhang_m), edges_(EdgesOf(solid_)) {
    for (const Face& face : solid_.face) normal_.push_back(NormalOf(solid_, face));
  }

  ModelParts Make() {
    AddFaces();
    FindRim();
    AddEdgesAndCorners();
    AddRim();
    return std::move(parts_);
  }

 private:
  const Eigen::Vector3d& Normal(int face) const { return normal_[static_cast<size_t>(face)]; }
  FaceKind Kind(int face) const { return solid_.face[static_cast<size_t>(face)].kind; }

  // The edge's roof when a pitched roof ends there above a wall; else -1.
  int OverhangingRoof(const SolidEdge& edge) const {
    if (!(overhang_m_ > 0.0) || edge.other < 0 || !edge.convex) return -1;
    const bool first = Kind(edge.face) == FaceKind::kRoof;
    const int roof = first ? edge.face : edge.other, wall = first ? edge.other : edge.face;
    if (Kind(roof) != FaceKind::kRoof || Kind(wall) != FaceKind::kWall) return -1;
    const double up = Normal(roof).z();
    const bool pitched = up > 0.1 && up < std::cos(kLevel_rad);
    return pitched && std::abs(Normal(wall).z()) < 0.1 ? roof : -1;
  }

  void AddFaces() {
    for (size_t i = 0; i < solid_.face.size(); ++i) {
      const Face& face = solid_.face[i];
      if (face.kind == FaceKind::kGround || face.outer.size() < 3 || normal_[i].isZero()) continue;
      std::vector<std::vector<Eigen::Vector3d>> rings(1);
      for (const uint32_t v : face.outer) rings[0].push_back(solid_.vertex[v]);
      for (const auto& hole : face.holes) {
        auto& ring = rings.emplace_back();
        for (const uint32_t v : hole) ring.push_back(solid_.vertex[v]);
      }
      parts_.faces.push_back({face.kind, FlatPolygon(std::move(rings), normal_[i])});
    }
  }

  void FindRim() {
    for (const SolidEdge& edge : edges_) {
      const int roof = OverhangingRoof(edge);
      if (roof < 0) continue;
      const int wall = roof == edge.face ? edge.other : edge.face;
      for (const uint32_t v : {edge.from, edge.to}) {
        RimVertex& rim = rim_[v];
        AddDirection(Normal(wall), &rim.walls);
        AddDirection(Normal(roof), &rim.roofs);
        rim.plane_normal = Normal(roof);
      }
    }
  }

  void AddEdgesAndCorners() {
    std::map<uint32_t, std::vector<Eigen::Vector3d>> around;  // different normals of the faces at a vertex
    for (const SolidEdge& edge : edges_) {
      for (const int face : {edge.face, edge.other}) {
        if (face < 0 || Kind(face) == FaceKind::kGround || Normal(face).isZero()) continue;
        for (const uint32_t v : {edge.from, edge.to}) AddDirection(Normal(face), &around[v]);
      }
      const bool at_ground = Kind(edge.face) == FaceKind::kGround || (edge.other >= 0 && Kind(edge.other) == FaceKind::kGround);
      if (at_ground || edge.angle_rad <= kSharp_rad) continue;
      parts_.edges.push_back({solid_.vertex[edge.from], solid_.vertex[edge.to], OverhangingRoof(edge) >= 0});
    }
    for (const auto& [v, normals] : around) {
      if (normals.size() >= 3) parts_.corners.push_back({solid_.vertex[v], rim_.contains(v)});
    }
  }

  void AddRim() {
    for (const SolidEdge& edge : edges_) {
      const int roof = OverhangingRoof(edge);
      if (roof < 0) continue;
      const Eigen::Vector3d &a = solid_.vertex[edge.from], &b = solid_.vertex[edge.to];
      const Eigen::Vector3d a_out = OnPlane(a, Outwards(rim_.at(edge.from), overhang_m_), Normal(roof));
      const Eigen::Vector3d b_out = OnPlane(b, Outwards(rim_.at(edge.to), overhang_m_), Normal(roof));
      parts_.faces.push_back({FaceKind::kRoof, FlatPolygon({{a, b, b_out, a_out}}, Normal(roof))});
      parts_.edges.push_back({a_out, b_out, false});
    }
    for (const auto& [v, rim] : rim_) {
      const Eigen::Vector3d& place = solid_.vertex[v];
      const Eigen::Vector3d out = OnPlane(place, Outwards(rim, overhang_m_), rim.plane_normal);
      // A ridge, hip or valley goes on over the overhang.
      if (rim.roofs.size() >= 2) parts_.edges.push_back({place, out, false});
      if (rim.roofs.size() >= 2 || rim.walls.size() >= 2) parts_.corners.push_back({out, false});
    }
  }

  const Solid& solid_;
  double overhang_m_;
  std::vector<SolidEdge> edges_;
  std::vector<Eigen::Vector3d> normal_;
  std::map<uint32_t, RimVertex> rim_;
  ModelParts parts_;
};

}  // namespace

ModelParts PartsOf(const Building& building) {
  return PartsMaker(building).Make();
}

}  // namespace skyquilt::buildings
