// The surface that closes a hole.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "surface/mesh.h"

namespace skyquilt::surface {

struct HolePatch {
  std::vector<Eigen::Vector3d> inner;  // new vertices, numbered after those of the border
  std::vector<Triangle> triangle;      // counter-clockwise seen from above, each with a new vertex
};

// Whether edges of the polygon cross or touch where they are not neighbours, as seen from above. O(n^2).
bool CrossesItself(std::span<const Eigen::Vector3d> border);

// Triangulates a simple polygon that is counter-clockwise seen from above, without new vertices, by cutting off ears (Meisters 1975), O(n^2) as a
// rule. Nothing when rounding leaves no ear, as when all vertices are nearly on a line.
std::optional<std::vector<Triangle>> CutEars(std::span<const Eigen::Vector3d> border);

// The patch of such a polygon. Edges inside longer than spacing_m are halved, up to a number of vertices that the area asks for; heights form a
// membrane (each new vertex at the weighted mean of its neighbours; planes stay planes). spacing_m of 0 or less: edges are not halved.
std::optional<HolePatch> MakeHolePatch(std::span<const Eigen::Vector3d> border, double spacing_m);

}  // namespace skyquilt::surface
