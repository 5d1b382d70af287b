// How the surface crosses a cell of the lattice, from the signs at its eight corners: each sheet is a cycle of cell edges that change sign, linked
// face by face (dual marching cubes, Nielson 2004). A face with four crossings links them around its inside corners, so cells on both sides agree.
//
// That rule alone is not manifold: two cells may share two links between the same two sheets, and then four quads would meet at one edge of the dual
// mesh. Both cells then have a "doubtful" face, the one between them, and linking its crossings around its outside corners instead splits both sheets
// (Wenger, Isosurfaces, 2013). A cell has at most one doubtful face, so such choices never meet.
#pragma once

#include <array>
#include <cstdint>

namespace skyquilt::surface {

// Corner c of a cell is at offset (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4 a + ob + 2 oc runs along axis a from offset ob on axis a + 1 and oc on axis
// a + 2 (modulo 3). Face 2 a + s is perpendicular to axis a, at offset s.
constexpr int kCellCorners = 8;
constexpr int kCellEdges = 12;
constexpr int kCellFaces = 6;

inline int LowerCornerOfEdge(int edge) {
  const int axis = edge / 4;
  return (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
}

struct CellCycles {
  int n_cycles = 0;                         // at most 4
  std::array<uint8_t, 4> length{};          // edges of each cycle, at least 3
  std::array<uint8_t, kCellEdges> edges{};  // of all cycles, one after the other, each in the order in which faces link them
};

// signs: bit c is set when corner c is inside. With a `turned_face` >= 0 its links are around outside corners.
CellCycles LinkCycles(unsigned signs, int turned_face);

// LinkCycles for all signs.
struct CellTable {
  std::array<CellCycles, 256> cycles;
  std::array<CellCycles, 256> turned;       // with the doubtful face turned; as `cycles` where there is none
  std::array<int8_t, 256> doubtful_face{};  // both links of this face are in one cycle; -1: no such face
};
const CellTable& Cells();

}  // namespace skyquilt::surface
