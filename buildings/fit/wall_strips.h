// Where a shape has walls: the pieces of its lines at which a roof ends above something lower; and the points in front of them, sorted into strips:
// one per line, side and part.
#pragma once

#include <map>
#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_points.h"

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

struct StripKey {
  int axis = 0, line = 0, side = 1, part = 0;
  auto operator<=>(const StripKey&) const = default;
};

// Pieces of walls of one part along one line.
struct Strip {
  std::vector<WallPiece> pieces;
  bool sloped = false;   // the roof falls towards this wall
  bool pitched = false;  // of the part
  double rise = 0.0;     // of a pitched roof, metres per metre

  double Length() const;
  // The piece at a place along the wall, at least margin_m from its ends (less on short pieces); null: none.
  const WallPiece* At(double along, double margin_m) const;
};
// Walls that rise at least least_m.
std::map<StripKey, Strip> StripsOf(const Shape& shape, double least_m);

// A steep point that faces as the wall does.
struct StripPoint {
  const FitPoint* point = nullptr;
  double along = 0.0;  // the wall
  double out = 0.0;    // in front of it
  double below = 0.0;  // the rim of the roof, where it reaches over the wall by the overhang
  double above = 0.0;  // what is in front of the wall
};
std::vector<StripPoint> PointsOf(const Strip& strip, const FitPoints& points, const Shape& shape, double overhang_m, double margin_m, double reach_m);

}  // namespace skyquilt::buildings
