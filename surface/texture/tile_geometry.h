// The usable triangles of a tile with their normals and neighbours.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::surface {

// Survey ENU, metres. The vectors per triangle have the same length. Keeps a pointer to the mesh.
struct TileGeometry {
  const Mesh* mesh = nullptr;
  std::vector<Triangle> triangle;            // with an area, and with finite corners that exist
  std::vector<Eigen::Vector3d> face_normal;  // length 1
  std::vector<double> area;                  // square metres
  // Across the edge from corner i to corner i + 1; -1: none. Edges of three or more triangles, or of two with opposite orientation, have no
  // neighbours.
  std::vector<std::array<int32_t, 3>> neighbor;
  // Per vertex of the mesh, length 1: mean over its triangles, weighted by area; up where there is none. Triangles of other tiles are not known here,
  // so that shading has a small step at borders of tiles.
  std::vector<Eigen::Vector3d> vertex_normal;
  Eigen::Vector3d min_enu = Eigen::Vector3d::Zero(), max_enu = Eigen::Vector3d::Zero();  // of the usable triangles

  // Whether the triangle closes a gap: it may be further off than the measured surface.
  bool IsFilled(size_t t) const { return mesh->filled[triangle[t][0]] + mesh->filled[triangle[t][1]] + mesh->filled[triangle[t][2]] > 0; }
  const Eigen::Vector3d& Corner(size_t t, size_t corner) const { return mesh->position[triangle[t][corner]]; }
  // By the barycentric weights of the second and third corner.
  Eigen::Vector3d PositionAt(size_t t, double b1, double b2) const {
    const Eigen::Vector3d& first = Corner(t, 0);
    return first + b1 * (Corner(t, 1) - first) + b2 * (Corner(t, 2) - first);
  }
  // Interpolated between the vertices, length 1; the face's normal where these cancel out.
  Eigen::Vector3d NormalAt(size_t t, double b1, double b2) const;
};

TileGeometry GeometryOf(const Mesh& mesh);

}  // namespace skyquilt::surface
