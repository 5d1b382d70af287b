#include "buildings/pictures/wall_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "buildings/classes/solid_edges.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSameDirection_rad = 1.0 * std::numbers::pi / 180.0;
constexpr double kSamePlane_m = 0.05;
constexpr double kTouching_m = 0.05;

struct WallFace {
  size_t face = 0;
  Eigen::Vector3d normal;
  double from = 0.0, to = 0.0;  // along the wall's right hand
};
struct Wall {
  Eigen::Vector3d normal, right, place;  // of its first face
  std::vector<WallFace> faces;
  double from = 0.0, to = 0.0;
};

bool InPlane(const Solid& solid, const Wall& wall, size_t face, const Eigen::Vector3d& normal) {
  if (wall.normal.dot(normal) < std::cos(kSameDirection_rad)) return false;
  const std::vector<uint32_t>& ring = solid.face[face].outer;
  return std::all_of(ring.begin(), ring.end(), [&](uint32_t v) { return std::abs((solid.vertex[v] - wall.place).dot(wall.normal)) < kSamePlane_m; });
}

// The places of a face along a direction.
void MeasureFace(const Solid& solid, const Eigen::Vector3d& right, WallFace* face) {
  face->from = std::numeric_limits<double>::infinity();
  face->to = -face->from;
  for (const uint32_t v : solid.face[face->face].outer) {
    const double along = right.dot(solid.vertex[v]);
    face->from = std::min(face->from, along);
    face->to = std::max(face->to, along);
  }
}

// Walls of one plane whose faces touch become one.
void JoinTouching(std::vector<Wall>* walls) {
  for (size_t i = 0; i < walls->size(); ++i) {
    for (size_t j = i + 1; j < walls->size();) {
      Wall &a = (*walls)[i], &b = (*walls)[j];
      const bool same = (a.normal - b.normal).norm() < kSameDirection_rad && std::abs((b.place - a.place).dot(a.normal)) < kSamePlane_m;
      if (!same || b.from > a.to + kTouching_m || b.to < a.from - kTouching_m) {
        ++j;
        continue;
      }
      a.from = std::min(a.from, b.from);
      a.to = std::max(a.to, b.to);
      a.faces.insert(a.faces.end(), b.faces.begin(), b.faces.end());
      walls->erase(walls->begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;  // the longer wall may touch one that was passed
    }
  }
}

WallSide SideOf(const Solid& solid, const Wall& wall) {
  WallSide side;
  side.normal = wall.normal;
  side.right = wall.right;
  double top = -std::numeric_limits<double>::infinity(), bottom = -top;
  for (const WallFace& face : wall.faces) {
    for (const uint32_t v : solid.face[face.face].outer) {
      top = std::max(top, solid.vertex[v].z());
      bottom = std::min(bottom, solid.vertex[v].z());
    }
  }
  side.width_m = wall.to - wall.from;
  side.height_m = top - bottom;
  const Eigen::Vector3d level(wall.place.x(), wall.place.y(), top);
  side.top_left = level + (wall.from - wall.right.dot(wall.place)) * wall.right;
  for (const WallFace& face : wall.faces) {
    std::vector<std::vector<uint32_t>> rings = solid.face[face.face].holes;
    rings.insert(rings.begin(), solid.face[face.face].outer);
    for (const auto& ring : rings) {
      auto& flat = side.rings.emplace_back();
      for (const uint32_t v : ring) flat.emplace_back(wall.right.dot(solid.vertex[v]) - wall.from, top - solid.vertex[v].z());
    }
  }
  return side;
}

}  // namespace

bool WallSide::Contains(const Eigen::Vector2d& place) const {
  bool inside = false;
  for (const auto& ring : rings) {
    for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const Eigen::Vector2d &a = ring[i], &b = ring[j];
      if ((a.y() > place.y()) == (b.y() > place.y())) continue;
      if (place.x() < a.x() + (b.x() - a.x()) * (place.y() - a.y()) / (b.y() - a.y())) inside = !inside;
    }
  }
  return inside;
}

std::vector<WallSide> WallSidesOf(const Solid& solid) {
  std::vector<Wall> walls;
  for (size_t i = 0; i < solid.face.size(); ++i) {
    const Face& face = solid.face[i];
    if (face.kind != FaceKind::kWall || face.outer.size() < 3) continue;
    Eigen::Vector3d normal = NormalOf(solid, face);
    normal.z() = 0.0;
    if (!(normal.norm() > 0.5)) continue;
    normal.normalize();
    WallFace wall_face{i, normal, 0.0, 0.0};
    const auto same = std::find_if(walls.begin(), walls.end(), [&](const Wall& wall) { return InPlane(solid, wall, i, normal); });
    // Faces of one plane are measured along one direction, so that they can be compared.
    Wall wall;
    wall.normal = same == walls.end() ? normal : same->normal;
    wall.right = Eigen::Vector3d::UnitZ().cross(wall.normal);
    wall.place = same == walls.end() ? solid.vertex[face.outer[0]] : same->place;
    MeasureFace(solid, wall.right, &wall_face);
    wall.from = wall_face.from;
    wall.to = wall_face.to;
    wall.faces = {wall_face};
    walls.push_back(std::move(wall));
  }
  JoinTouching(&walls);
  std::vector<WallSide> sides;
  for (const Wall& wall : walls) sides.push_back(SideOf(solid, wall));
  return sides;
}

}  // namespace skyquilt::buildings
