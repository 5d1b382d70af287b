// The one lattice of the survey on which depths are fused: its nodes are at index * voxel_m in survey ENU, so that pieces computed apart, in any
// order and on any rank, share nodes and the vertices between them.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace skyquilt::surface {

// Half-open box of lattice indices. A cell, and what is computed for it, belongs to the piece that holds its lowest corner.
struct LatticeBox {
  Eigen::Vector3i min = Eigen::Vector3i::Zero();
  Eigen::Vector3i max = Eigen::Vector3i::Zero();
};

// Key of a mesh vertex: the cell (20 bits each for x and y, 18 for z, as two's complement) and the number of the sheet in it (0 to 3; a cell may be
// crossed by up to four sheets). Different cells within +-2^19 (x, y) and +-2^17 (z) voxels of the origin have different keys.
inline uint64_t VertexKey(const Eigen::Vector3i& cell, int sheet) {
  const auto bits = [](int value, unsigned n) { return static_cast<uint64_t>(static_cast<uint32_t>(value)) & ((uint64_t{1} << n) - 1); };
  return bits(cell.x(), 20) << 44U | bits(cell.y(), 20) << 24U | bits(cell.z(), 18) << 6U | static_cast<uint64_t>(sheet);
}

// Whether a piece and its halo are inside the part of the lattice in which VertexKey tells all cells apart.
inline bool HasDistinctKeys(const LatticeBox& box) {
  const Eigen::Array3i limit(1 << 19, 1 << 19, 1 << 17);
  constexpr int kHalo = 16;
  return (box.min.array() >= -limit + kHalo).all() && (box.max.array() <= limit - kHalo).all();
}

}  // namespace skyquilt::surface
