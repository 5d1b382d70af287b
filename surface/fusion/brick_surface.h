// The part of the surface in one brick: its vertices, and the lattice edges that become quads.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "surface/fusion/bricks.h"
#include "surface/fusion/integrate.h"

namespace skyquilt::surface {

// A cell with vertices.
struct CellVertices {
  static constexpr uint8_t kNone = 255;
  uint16_t cell;                    // NodeInBrick of its lowest corner
  std::array<uint8_t, 12> of_edge;  // the vertex of the quad across each edge, counted from first_vertex; kNone: no quad
  uint32_t first_vertex;            // in the brick
};

// An edge of the lattice whose ends are on different sides of the surface, with a quad across it.
struct QuadEdge {
  uint16_t node;  // NodeInBrick of its lower end
  uint8_t axis;
  bool inside_is_lower;
};

struct BrickSurface {
  std::vector<CellVertices> cells;  // sorted by cell
  std::vector<QuadEdge> quads;      // those that belong to the piece
  std::vector<Eigen::Vector3d> position;
  std::vector<uint64_t> key;
  std::vector<uint8_t> views;

  // The vertex of a cell for the quad across one of its edges, counted in the brick; the quad must exist.
  uint32_t VertexOf(uint16_t cell, int edge) const;
};

// The vertices of the cells of a brick that quads of this piece or of its neighbours need, and the quads of the piece. A sheet of which some quads
// are not kept has one vertex per run of kept quads around it, so that parts of the surface never touch in a single point.
BrickSurface SurfaceOfBrick(const Bricks& bricks, const NodeField& field, size_t brick, const LatticeBox& piece, const FuseOptions& options);

}  // namespace skyquilt::surface
