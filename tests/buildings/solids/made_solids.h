// Solids by hand for tests, and what can be asked of any solid.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "buildings/solids/build_solids.h"
#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// A box with its first corner at a place. Faces: ground, roof, then the walls to the south, east, north and west.
inline Solid MakeBox(const Eigen::Vector3d& corner, const Eigen::Vector3d& size) {
  Solid box;
  for (const double z : {0.0, size.z()}) {
    for (const Eigen::Vector2d& p : {Eigen::Vector2d(0.0, 0.0), {size.x(), 0.0}, {size.x(), size.y()}, {0.0, size.y()}}) {
      box.vertex.emplace_back(corner + Eigen::Vector3d(p.x(), p.y(), z));
    }
  }
  box.face = {{FaceKind::kGround, {3, 2, 1, 0}, {}}, {FaceKind::kRoof, {4, 5, 6, 7}, {}}, {FaceKind::kWall, {0, 1, 5, 4}, {}},
              {FaceKind::kWall, {1, 2, 6, 5}, {}},   {FaceKind::kWall, {2, 3, 7, 6}, {}}, {FaceKind::kWall, {3, 0, 4, 7}, {}}};
  return box;
}

// A podium of 10 m by 10 m and 4 m height with a tower of 2 m by 2 m up to 10 m in its middle. Face 1 is the deck, with a hole; vertices 8 to 11 are
// the tower's foot, 12 to 15 its top, face 6 its roof.
inline Solid MakePodium() {
  Solid solid = MakeBox({0.0, 0.0, 0.0}, {10.0, 10.0, 4.0});
  const Solid tower = MakeBox({4.0, 4.0, 4.0}, {2.0, 2.0, 6.0});
  solid.vertex.insert(solid.vertex.end(), tower.vertex.begin(), tower.vertex.end());
  solid.face[1].holes.push_back({11, 10, 9, 8});
  for (size_t f = 1; f < tower.face.size(); ++f) {
    Face face = tower.face[f];
    for (uint32_t& v : face.outer) v += 8;
    solid.face.push_back(face);
  }
  return solid;
}

// Both solids in one, whose vertices at equal places are one.
inline Solid Together(const Solid& a, const Solid& b) {
  Solid both = a;
  std::vector<uint32_t> number;
  for (const Eigen::Vector3d& v : b.vertex) {
    uint32_t n = 0;
    while (n < both.vertex.size() && both.vertex[n] != v) ++n;
    if (n == both.vertex.size()) both.vertex.push_back(v);
    number.push_back(n);
  }
  for (Face face : b.face) {
    for (uint32_t& v : face.outer) v = number[v];
    for (auto& hole : face.holes) {
      for (uint32_t& v : hole) v = number[v];
    }
    both.face.push_back(face);
  }
  return both;
}

inline int FacesOf(const Solid& solid, FaceKind kind) {
  int n = 0;
  for (const Face& face : solid.face) n += face.kind == kind ? 1 : 0;
  return n;
}

// "304 304 " and so on, with the sentences: for messages of tests.
inline std::string TextOf(const std::vector<SolidProblem>& problems) {
  std::string text;
  for (const SolidProblem& problem : problems) text += std::to_string(problem.code) + ": " + problem.text + "\n";
  return text;
}

}  // namespace skyquilt::buildings
