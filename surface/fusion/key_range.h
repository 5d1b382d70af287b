// The part of the lattice in which VertexKey tells all cells apart.
#pragma once

#include "surface/fusion/fusion_lattice.h"

namespace skyquilt::surface {

// Whether a piece and its halo are inside it.
inline bool HasDistinctKeys(const LatticeBox& box) {
  const Eigen::Array3i limit(1 << 19, 1 << 19, 1 << 17);
  constexpr int kHalo = 16;
  return (box.min.array() >= -limit + kHalo).all() && (box.max.array() <= limit - kHalo).all();
}

}  // namespace skyquilt::surface
