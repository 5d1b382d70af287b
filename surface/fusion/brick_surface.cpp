#include "surface/fusion/brick_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "surface/fusion/cell_cycles.h"

namespace skyquilt::surface {
namespace {

// Crossings are kept this far from nodes, in voxels, so that triangles around a node do not shrink to a point.
constexpr double kLeastOffset = 0.01;

// The nodes of a brick and of its surroundings: from 1 before it to 2 behind it.
struct NearNodes {
  static constexpr int kSide = kBrickSide + 3;
  static constexpr size_t kCount = static_cast<size_t>(kSide * kSide * kSide);
  std::array<float, kCount> psi;
  std::array<uint8_t, kCount> views;
  std::array<uint8_t, kCount> photos;

  // For coordinates from -1 to 9, relative to the brick.
  static size_t Index(const Eigen::Vector3i& node) { return static_cast<size_t>(node.x() + 1 + kSide * (node.y() + 1 + kSide * (node.z() + 1))); }
};

void CopyNodes(const Bricks& bricks, const NodeField& field, const Eigen::Vector3i& brick, NearNodes* near) {
  near->psi.fill(std::numeric_limits<float>::quiet_NaN());
  near->views.fill(0);
  near->photos.fill(0);
  for (int n = 0; n < 27; ++n) {
    const Eigen::Vector3i to_neighbour = Eigen::Vector3i(n % 3, n / 3 % 3, n / 9) - Eigen::Vector3i::Ones();
    const int64_t neighbour = bricks.Find(brick + to_neighbour);
    if (neighbour < 0) continue;
    const size_t first = static_cast<size_t>(neighbour) * static_cast<size_t>(kBrickNodes);
    const Eigen::Vector3i begin = (kBrickSide * to_neighbour).cwiseMax(-1);
    const Eigen::Vector3i end = (kBrickSide * (to_neighbour + Eigen::Vector3i::Ones())).cwiseMin(kBrickSide + 2);
    for (int z = begin.z(); z < end.z(); ++z) {
      for (int y = begin.y(); y < end.y(); ++y) {
        const size_t from = first + NodeInBrick(begin.x(), y, z);
        const size_t to = NearNodes::Index({begin.x(), y, z});
        const auto count = static_cast<size_t>(end.x() - begin.x());
        std::copy_n(&field.psi[from], count, &near->psi[to]);
        std::copy_n(&field.views[from], count, &near->views[to]);
        std::copy_n(&field.photos[from], count, &near->photos[to]);
      }
    }
  }
}

// Signs of the cells from 1 before the brick to 1 behind it.
struct NearCells {
  static constexpr int kSide = kBrickSide + 2;
  static constexpr int16_t kUnknown = -1;
  std::array<int16_t, static_cast<size_t>(kSide* kSide* kSide)> signs;  // kUnknown: a corner is not known

  // For coordinates from -1 to 8.
  int16_t At(const Eigen::Vector3i& cell) const { return signs[static_cast<size_t>(cell.x() + 1 + kSide * (cell.y() + 1 + kSide * (cell.z() + 1)))]; }
};

// False when the surface crosses none of them.
bool FindSigns(const NearNodes& nodes, NearCells* cells) {
  bool crossed = false;
  size_t i = 0;
  for (int z = -1; z <= kBrickSide; ++z) {
    for (int y = -1; y <= kBrickSide; ++y) {
      for (int x = -1; x <= kBrickSide; ++x) {
        const size_t lowest = NearNodes::Index({x, y, z});
        unsigned signs = 0;
        bool known = true;
        for (unsigned c = 0; c < kCellCorners; ++c) {
          constexpr size_t kRow = NearNodes::kSide;
          const float psi = nodes.psi[lowest + (c & 1U) + (c >> 1U & 1U) * kRow + (c >> 2U) * kRow * kRow];
          known = known && !std::isnan(psi);
          signs |= (psi < 0.0F ? 1U : 0U) << c;
        }
        cells->signs[i++] = known ? static_cast<int16_t>(signs) : NearCells::kUnknown;
        crossed = crossed || (known && signs != 0 && signs != 255);
      }
    }
  }
  return crossed;
}

class BrickExtractor {
 public:
  BrickExtractor(const NearNodes& nodes, const NearCells& cells, const FuseOptions& options, const Eigen::Vector3i& first_node)
      : nodes_(nodes), cells_(cells), options_(options), first_node_(first_node) {}

  void AddCell(const Eigen::Vector3i& cell, BrickSurface* surface) const {
    const int16_t signs = cells_.At(cell);
    if (signs == NearCells::kUnknown || signs == 0 || signs == 255) return;
    const CellCycles& cycles = CyclesOf(cell, static_cast<size_t>(signs));
    CellVertices cell_vertices{static_cast<uint16_t>(NodeInBrick(cell.x(), cell.y(), cell.z())), {}, static_cast<uint32_t>(surface->key.size())};
    cell_vertices.of_edge.fill(CellVertices::kNone);
    const uint8_t* cycle = cycles.edges.data();
    for (size_t i = 0; i < static_cast<size_t>(cycles.n_cycles); ++i) {
      AddSheet(cell, cycle, cycles.length[i], &cell_vertices, surface);
      cycle += cycles.length[i];
    }
    if (surface->key.size() > cell_vertices.first_vertex) surface->cells.push_back(cell_vertices);
  }

  void AddQuads(const Eigen::Vector3i& node, BrickSurface* surface) const {
    const float psi = nodes_.psi[NearNodes::Index(node)];
    for (int axis = 0; axis < 3; ++axis) {
      // A comparison with NaN is false on both sides; whether both ends are known is part of IsKept.
      const bool lower_inside = psi < 0.0F;
      const bool upper_inside = nodes_.psi[NearNodes::Index(node + Eigen::Vector3i::Unit(axis))] < 0.0F;
      if (lower_inside == upper_inside || !IsKept(node, axis)) continue;
      surface->quads.push_back({static_cast<uint16_t>(NodeInBrick(node.x(), node.y(), node.z())), static_cast<uint8_t>(axis), lower_inside});
    }
  }

 private:
  // Whether there is a quad across the edge from the node, given that the surface crosses it. The same in all pieces.
  bool IsKept(const Eigen::Vector3i& node, int axis) const {
    const size_t a = NearNodes::Index(node);
    const size_t b = NearNodes::Index(node + Eigen::Vector3i::Unit(axis));
    if (std::max(nodes_.views[a], nodes_.views[b]) < options_.min_views || std::max(nodes_.photos[a], nodes_.photos[b]) < options_.min_photos)
      return false;
    const Eigen::Vector3i to_b = Eigen::Vector3i::Unit((axis + 1) % 3);
    const Eigen::Vector3i to_c = Eigen::Vector3i::Unit((axis + 2) % 3);
    return cells_.At(node) != NearCells::kUnknown && cells_.At(node - to_b) != NearCells::kUnknown && cells_.At(node - to_c) != NearCells::kUnknown &&
           cells_.At(node - to_b - to_c) != NearCells::kUnknown;
  }

  // A doubtful face is turned when it is doubtful for the cell on its other side too.
  const CellCycles& CyclesOf(const Eigen::Vector3i& cell, size_t signs) const {
    const CellTable& table = Cells();
    const int face = table.doubtful_face[signs];
    if (face < 0) return table.cycles[signs];
    const Eigen::Vector3i towards = Eigen::Vector3i::Unit(face / 2) * ((face & 1) != 0 ? 1 : -1);
    const int16_t neighbour = cells_.At(cell + towards);
    const bool turned = neighbour != NearCells::kUnknown && table.doubtful_face[static_cast<size_t>(neighbour)] == (face ^ 1);
    return turned ? table.turned[signs] : table.cycles[signs];
  }

  Eigen::Vector3i LowerEnd(const Eigen::Vector3i& cell, int edge) const {
    const int corner = LowerCornerOfEdge(edge);
    return cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2 & 1);
  }

  // Where the surface crosses an edge, in voxels from the lowest corner of the cell.
  Eigen::Vector3d Crossing(const Eigen::Vector3i& cell, int edge) const {
    const Eigen::Vector3i lower = LowerEnd(cell, edge);
    const auto from = static_cast<double>(nodes_.psi[NearNodes::Index(lower)]);
    const auto to = static_cast<double>(nodes_.psi[NearNodes::Index(lower + Eigen::Vector3i::Unit(edge / 4))]);
    Eigen::Vector3d crossing = (lower - cell).cast<double>();
    crossing[edge / 4] += std::clamp(from / (from - to), kLeastOffset, 1.0 - kLeastOffset);
    return crossing;
  }

  uint8_t ViewsOf(const Eigen::Vector3i& cell, int edge) const {
    const Eigen::Vector3i lower = LowerEnd(cell, edge);
    return std::max(nodes_.views[NearNodes::Index(lower)], nodes_.views[NearNodes::Index(lower + Eigen::Vector3i::Unit(edge / 4))]);
  }

  void AddSheet(const Eigen::Vector3i& cell, const uint8_t* cycle, size_t length, CellVertices* cell_vertices, BrickSurface* surface) const {
    std::array<bool, kCellEdges> kept{};
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < length; ++i) {
      kept[i] = IsKept(LowerEnd(cell, cycle[i]), cycle[i] / 4);
      sum += Crossing(cell, cycle[i]);
    }
    // Begin behind a quad that is not kept, so that no run of kept ones is cut in two; with all kept any edge will do.
    const auto gap = static_cast<size_t>(std::find(kept.begin(), kept.begin() + length, false) - kept.begin());
    const Eigen::Vector3i global = first_node_ + cell;
    bool in_run = false;
    for (size_t i = 0; i < length; ++i) {
      const size_t at = (gap + i) % length;
      if (!kept[at]) {
        in_run = false;
        continue;
      }
      if (!in_run) {
        in_run = true;
        const auto number = static_cast<int>(surface->key.size() - cell_vertices->first_vertex);
        surface->position.emplace_back((global.cast<double>() + sum / static_cast<double>(length)) * options_.voxel_m);
        surface->key.push_back(VertexKey(global, number));
        surface->views.push_back(0);
      }
      cell_vertices->of_edge[cycle[at]] = static_cast<uint8_t>(surface->key.size() - 1 - cell_vertices->first_vertex);
      surface->views.back() = std::max(surface->views.back(), ViewsOf(cell, cycle[at]));
    }
  }

  const NearNodes& nodes_;
  const NearCells& cells_;
  const FuseOptions& options_;
  Eigen::Vector3i first_node_;
};

}  // namespace

uint32_t BrickSurface::VertexOf(uint16_t cell, int edge) const {
  const auto found = std::lower_bound(cells.begin(), cells.end(), cell, [](const CellVertices& a, uint16_t wanted) { return a.cell < wanted; });
  SKYQUILT_CHECK(found != cells.end() && found->cell == cell && found->of_edge[static_cast<size_t>(edge)] != CellVertices::kNone,
                 "a quad of the surface has no vertex in one of its cells");
  return found->first_vertex + found->of_edge[static_cast<size_t>(edge)];
}

BrickSurface SurfaceOfBrick(const Bricks& bricks, const NodeField& field, size_t brick, const LatticeBox& piece, const FuseOptions& options) {
  const Eigen::Vector3i coordinate = BrickOfKey(bricks.key[brick]);
  const Eigen::Vector3i first_node = kBrickSide * coordinate;
  // Cells of the piece's quads, which reach one before it, relative to the brick.
  const Eigen::Vector3i begin = (piece.min - Eigen::Vector3i::Ones() - first_node).cwiseMax(0);
  const Eigen::Vector3i end = (piece.max - first_node).cwiseMin(kBrickSide);
  BrickSurface surface;
  if ((begin.array() >= end.array()).any()) return surface;
  NearNodes nodes;
  NearCells cells;
  CopyNodes(bricks, field, coordinate, &nodes);
  if (!FindSigns(nodes, &cells)) return surface;
  const BrickExtractor extractor(nodes, cells, options, first_node);
  for (int z = begin.z(); z < end.z(); ++z) {
    for (int y = begin.y(); y < end.y(); ++y) {
      for (int x = begin.x(); x < end.x(); ++x) {
        const Eigen::Vector3i cell(x, y, z);
        extractor.AddCell(cell, &surface);
        if (((first_node + cell).array() >= piece.min.array()).all()) extractor.AddQuads(cell, &surface);
      }
    }
  }
  return surface;
}

}  // namespace skyquilt::surface
