#include "surface/fusion/cell_cycles.h"

#include <algorithm>

namespace skyquilt::surface {
namespace {

int EdgeBetween(int corner_a, int corner_b) {
  const int difference = corner_a ^ corner_b;
  const int axis = difference == 1 ? 0 : difference == 2 ? 1 : 2;
  const int lower = std::min(corner_a, corner_b);
  return 4 * axis + (lower >> (axis + 1) % 3 & 1) + 2 * (lower >> (axis + 2) % 3 & 1);
}

// Corners in the order around the face.
std::array<int, 4> CornersOfFace(int face) {
  const int axis = face / 2;
  const int fixed = (face & 1) << axis;
  const int b = 1 << (axis + 1) % 3;
  const int c = 1 << (axis + 2) % 3;
  return {fixed, fixed | b, fixed | b | c, fixed | c};
}

// Each crossing edge has one link in both of its faces.
struct EdgeLinks {
  std::array<std::array<int8_t, 2>, kCellEdges> to;
  std::array<std::array<int8_t, 2>, kCellEdges> face;
  std::array<int8_t, kCellEdges> count{};

  void AddOneWay(int from, int to_edge, int in_face) {
    const auto i = static_cast<size_t>(from);
    const auto slot = static_cast<size_t>(count[i]++);
    to[i][slot] = static_cast<int8_t>(to_edge);
    face[i][slot] = static_cast<int8_t>(in_face);
  }
  void Add(int a, int b, int in_face) {
    AddOneWay(a, b, in_face);
    AddOneWay(b, a, in_face);
  }
};

EdgeLinks LinkEdges(unsigned signs, int turned_face) {
  EdgeLinks links{};
  for (int face = 0; face < kCellFaces; ++face) {
    const std::array<int, 4> corners = CornersOfFace(face);
    const auto inside = [&](size_t i) { return (signs >> static_cast<unsigned>(corners[i % 4]) & 1U) != 0; };
    // edge[i] is between corners i and i + 1.
    std::array<int, 4> edge{};
    std::array<int, 4> crossing{};
    int n_crossing = 0;
    for (size_t i = 0; i < 4; ++i) {
      edge[i] = EdgeBetween(corners[i], corners[(i + 1) % 4]);
      if (inside(i) != inside(i + 1)) crossing[static_cast<size_t>(n_crossing++)] = edge[i];
    }
    if (n_crossing == 2) links.Add(crossing[0], crossing[1], face);
    if (n_crossing != 4) continue;
    for (size_t i = 0; i < 4; ++i) {
      if (inside(i) != (face == turned_face)) links.Add(edge[(i + 3) % 4], edge[i], face);
    }
  }
  return links;
}

// Number of links of the face that are part of the cycle.
int LinksInCycle(const EdgeLinks& links, const uint8_t* cycle, int length, int face) {
  int ends = 0;
  for (int i = 0; i < length; ++i) {
    for (const int8_t of : links.face[cycle[i]]) ends += of == face ? 1 : 0;
  }
  return ends / 2;
}

int DoubtfulFace(unsigned signs, const CellCycles& cell) {
  const EdgeLinks links = LinkEdges(signs, -1);
  for (int face = 0; face < kCellFaces; ++face) {
    const uint8_t* cycle = cell.edges.data();
    for (size_t i = 0; i < static_cast<size_t>(cell.n_cycles); ++i) {
      if (LinksInCycle(links, cycle, cell.length[i], face) == 2) return face;
      cycle += cell.length[i];
    }
  }
  return -1;
}

}  // namespace

CellCycles LinkCycles(unsigned signs, int turned_face) {
  const EdgeLinks links = LinkEdges(signs, turned_face);
  CellCycles cell;
  std::array<bool, kCellEdges> done{};
  size_t n_edges = 0;
  for (size_t start = 0; start < kCellEdges; ++start) {
    if (links.count[start] == 0 || done[start]) continue;
    const size_t first = n_edges;
    size_t edge = start;
    int8_t through = links.face[start][1];
    do {
      done[edge] = true;
      cell.edges[n_edges++] = static_cast<uint8_t>(edge);
      // Leave by the face that the cycle did not come from.
      const size_t slot = links.face[edge][0] == through ? 1 : 0;
      through = links.face[edge][slot];
      edge = static_cast<size_t>(links.to[edge][slot]);
    } while (edge != start);
    cell.length[static_cast<size_t>(cell.n_cycles++)] = static_cast<uint8_t>(n_edges - first);
  }
  return cell;
}

const CellTable& Cells() {
  static const CellTable table = [] {
    CellTable cells;
    for (unsigned signs = 0; signs < 256; ++signs) {
      cells.cycles[signs] = LinkCycles(signs, -1);
      const int face = DoubtfulFace(signs, cells.cycles[signs]);
      cells.doubtful_face[signs] = static_cast<int8_t>(face);
      cells.turned[signs] = face < 0 ? cells.cycles[signs] : LinkCycles(signs, face);
    }
    return cells;
  }();
  return table;
}

}  // namespace skyquilt::surface
