// Points in front of walls, sorted into strips: one per line, side and part.
#pragma once

#include <map>
#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_points.h"
#include "buildings/fit/wall_pieces.h"

namespace skyquilt::buildings {

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
