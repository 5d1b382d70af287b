#include <unordered_map>

#include "buildings/solids/face_plane.h"
#include "buildings/solids/flat_triangles.h"
#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

SolidTriangles Triangulate(const Solid& solid) {
  SolidTriangles triangles;
  for (size_t f = 0; f < solid.face.size(); ++f) {
    const Face& face = solid.face[f];
    const FacePlane plane = PlaneOf(solid, face);
    std::vector<Eigen::Vector2d> place;
    std::vector<uint32_t> vertex;
    std::unordered_map<uint32_t, uint32_t> number;  // vertices that rings share are one point
    const auto numbered = [&](const std::vector<uint32_t>& ring) {
      std::vector<uint32_t> own;
      for (const uint32_t v : ring) {
        const auto [found, is_new] = number.emplace(v, static_cast<uint32_t>(vertex.size()));
        if (is_new) {
          vertex.push_back(v);
          place.push_back(plane.Project(solid.vertex[v]));
        }
        own.push_back(found->second);
      }
      return own;
    };
    std::vector<std::vector<uint32_t>> rings = {numbered(face.outer)};
    for (const std::vector<uint32_t>& hole : face.holes) {
      if (hole.size() >= 3) rings.push_back(numbered(hole));
    }
    for (const auto& [a, b, c] : FlatTriangles(place, rings)) {
      triangles.triangle.push_back({vertex[a], vertex[b], vertex[c]});
      triangles.face.push_back(static_cast<uint32_t>(f));
    }
  }
  return triangles;
}

}  // namespace skyquilt::buildings
