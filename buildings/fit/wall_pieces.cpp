#include "buildings/fit/wall_pieces.h"

#include <cmath>

namespace skyquilt::buildings {
namespace {

constexpr double kBeside_m = 1e-3;  // from the line, to ask what is on its sides

Eigen::Vector2d PlaceAt(const Shape& shape, const WallPiece& piece, double along, double in_front) {
  Eigen::Vector2d uv;
  uv[piece.axis] = (piece.axis == 0 ? shape.u : shape.v)[static_cast<size_t>(piece.line)] + piece.side * in_front;
  uv[1 - piece.axis] = along;
  return uv;
}

}  // namespace

WallHeights HeightsAt(const Shape& shape, const WallPiece& piece, double along) {
  const double before = RoofHeight(shape, PlaceAt(shape, piece, along, kBeside_m));
  const double above = RoofHeight(shape, shape.parts[static_cast<size_t>(piece.part)], PlaceAt(shape, piece, along, 0.0));
  return {std::isnan(before) ? shape.ground_z : before, above};
}

std::vector<WallPiece> WallPieces(const Shape& shape, double least_m) {
  std::vector<WallPiece> pieces;
  for (size_t p = 0; p < shape.parts.size(); ++p) {
    const Part& part = shape.parts[p];
    for (const int axis : {0, 1}) {
      const std::vector<double>& across = axis == 0 ? shape.v : shape.u;
      const int first = axis == 0 ? part.v0 : part.u0, last = axis == 0 ? part.v1 : part.u1;
      for (const int side : {-1, 1}) {
        WallPiece piece;
        piece.axis = axis;
        piece.side = side;
        piece.part = static_cast<int>(p);
        piece.line = axis == 0 ? (side < 0 ? part.u0 : part.u1) : (side < 0 ? part.v0 : part.v1);
        for (int i = first; i < last; ++i) {
          piece.from = across[static_cast<size_t>(i)];
          piece.to = across[static_cast<size_t>(i) + 1];
          const double middle = 0.5 * (piece.from + piece.to);
          int top = -1;
          RoofHeight(shape, PlaceAt(shape, piece, middle, -kBeside_m), &top);
          const WallHeights heights = HeightsAt(shape, piece, middle);
          if (top != piece.part || heights.top - heights.bottom < least_m) continue;
          piece.outer = std::isnan(RoofHeight(shape, PlaceAt(shape, piece, middle, kBeside_m)));
          pieces.push_back(piece);
        }
      }
    }
  }
  return pieces;
}

}  // namespace skyquilt::buildings
