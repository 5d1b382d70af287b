// Where a shape has walls: the pieces of its lines at which a roof ends above something lower.
#pragma once

#include <vector>

#include "buildings/building.h"

namespace skyquilt::buildings {

// A stretch of one wall of a part. axis 0: the wall is the line u = u[line] and runs along v; axis 1: v = v[line].
struct WallPiece {
  int axis = 0;
  int line = 0;
  int side = 1;                 // +1: faces the growing coordinate
  int part = 0;                 // whose roof ends here
  double from = 0.0, to = 0.0;  // along the other axis
  bool outer = true;            // the ground is in front of it; false: a lower roof
};
// Pieces between neighbouring lines, in the order of the parts; a wall rises at least least_m above what is in front of it (at its middle).
std::vector<WallPiece> WallPieces(const Shape& shape, double least_m);

// Heights at a place along the wall: of what is in front of it and of the roof's plane above it.
struct WallHeights {
  double bottom = 0.0, top = 0.0;
};
WallHeights HeightsAt(const Shape& shape, const WallPiece& piece, double along);

// Signed distance of a place in front of the wall (positive: outside).
inline double InFront(const Shape& shape, const WallPiece& piece, const Eigen::Vector2d& uv) {
  const double at = (piece.axis == 0 ? shape.u : shape.v)[static_cast<size_t>(piece.line)];
  return piece.side * (uv[piece.axis] - at);
}

}  // namespace skyquilt::buildings
