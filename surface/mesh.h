// The triangle mesh of a surface, and its tiles. Frame: survey ENU, metres, double; triangles are counter-clockwise seen from the free space.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace skyquilt::surface {

using Triangle = std::array<uint32_t, 3>;

// The vectors per vertex have the same length.
struct Mesh {
  std::vector<Eigen::Vector3d> position;
  std::vector<uint64_t> key;    // identity of the vertex on the survey's lattice (fusion/fusion_lattice.h): the same in every piece
  std::vector<uint8_t> views;   // views that saw it, at most 255
  std::vector<uint8_t> filled;  // 1: closes a hole or gap: no measurement
  std::vector<Triangle> triangle;
};

// A tile of the quadtree. Level 0 is the finest; a tile of level l covers, seen from above,
// [column, column + 1) x [row, row + 1) times size_m * 2^l, from the frame's origin to the east and north; its children are those of level l - 1
// inside.
struct TileId {
  int level = 0;
  int column = 0;
  int row = 0;
  auto operator<=>(const TileId&) const = default;
  TileId Parent() const { return {level + 1, column >> 1, row >> 1}; }  // shifts round down for negative numbers too
  std::string Name() const { return std::to_string(level) + "_" + std::to_string(column) + "_" + std::to_string(row); }
};

// Triangles belong to the tile that holds their middle, so they may reach over its border.
struct MeshTile {
  TileId id;
  Mesh mesh;
  double error_m = 0.0;  // bound of the distance to the mesh before any simplification
};

// A tile with its texture. Vertices are repeated where charts of the texture meet; the vectors per vertex have the same length.
struct TexturedTile {
  TileId id;
  double error_m = 0.0;
  std::vector<Eigen::Vector3d> position;
  std::vector<Eigen::Vector3f> normal;  // length 1, ENU, out of the surface
  std::vector<Eigen::Vector2f> uv;      // of the atlas, (0, 0) its upper left corner, (1, 1) its lower right
  std::vector<uint8_t> views;
  std::vector<uint8_t> filled;
  std::vector<Triangle> triangle;
  int atlas_width = 0, atlas_height = 0;  // pixels
  std::vector<uint8_t> atlas_jpeg;        // RGB
};

// A point of the cloud.
struct CloudPoint {
  Eigen::Vector3d position;  // survey ENU, metres
  Eigen::Vector3f normal;    // length 1, ENU
  std::array<uint8_t, 3> rgb;
  uint8_t views = 0;
  uint8_t filled = 0;
  uint8_t las_class = 1;  // ASPRS: 1 unclassified, 2 ground
};

}  // namespace skyquilt::surface
