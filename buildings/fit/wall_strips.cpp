#include "buildings/fit/wall_strips.h"

#include <algorithm>
#include <cmath>

#include "buildings/fit/fit_parameters.h"

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

namespace {

constexpr double kFaces = 0.7;  // least cosine between the normals of point and wall, in plan
constexpr double kShareOfPiece = 0.2;

}  // namespace

double Strip::Length() const {
  double length = 0.0;
  for (const WallPiece& piece : pieces) length += piece.to - piece.from;
  return length;
}

const WallPiece* Strip::At(double along, double margin_m) const {
  for (const WallPiece& piece : pieces) {
    const double margin = std::min(margin_m, kShareOfPiece * (piece.to - piece.from));
    if (along >= piece.from + margin && along <= piece.to - margin) return &piece;
  }
  return nullptr;
}

std::map<StripKey, Strip> StripsOf(const Shape& shape, double least_m) {
  std::map<StripKey, Strip> strips;
  for (const WallPiece& piece : WallPieces(shape, least_m)) {
    const Part& part = shape.parts[static_cast<size_t>(piece.part)];
    Strip& strip = strips[{piece.axis, piece.line, piece.side, piece.part}];
    strip.pieces.push_back(piece);
    strip.pitched = IsPitched(part);
    if (!strip.pitched) continue;
    const Eigen::Vector2d half = 0.5 * (shape.MaxOf(part, false) - shape.MinOf(part, false));
    const bool hip = part.roof == RoofKind::kHip;
    strip.sloped = hip || piece.axis == (part.along_u ? 1 : 0);
    const double reach = hip ? half.minCoeff() : half[part.along_u ? 1 : 0];
    strip.rise = reach > 0.0 ? (part.ridge_z - part.eave_z) / reach : 0.0;
  }
  return strips;
}

std::vector<StripPoint> PointsOf(const Strip& strip, const FitPoints& points, const Shape& shape, double overhang_m, double margin_m,
                                 double reach_m) {
  std::vector<StripPoint> list;
  if (strip.pieces.empty()) return list;
  const WallPiece& first = strip.pieces.front();
  const Eigen::Vector2d out = first.side * (first.axis == 0 ? shape.AxisU() : shape.AxisV());
  for (const FitPoint& point : points.steep) {
    const Eigen::Vector2d uv = InAxes(shape, point.place);
    const double in_front = InFront(shape, first, uv);
    if (std::abs(in_front) > reach_m || point.normal.head<2>().dot(out) < kFaces) continue;
    const double along = uv[1 - first.axis];
    const WallPiece* piece = strip.At(along, margin_m);
    if (piece == nullptr) continue;
    const WallHeights heights = HeightsAt(shape, *piece, along);
    const double rim = heights.top - (strip.sloped ? strip.rise * overhang_m : 0.0);
    list.push_back({&point, along, in_front, rim - point.z, point.z - heights.bottom});
  }
  return list;
}

}  // namespace skyquilt::buildings
