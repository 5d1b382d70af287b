// Union of rectangles with sides along two axes, as rings of corners. Made for outlines of simulated buildings, which must not depend on the code
// that is tested with them.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace skyquilt::simulate {

struct Rectangle2d {
  Eigen::Vector2d min, max;
};

using Ring = std::vector<Eigen::Vector2d>;  // the first point is not repeated at the end

struct RectangleUnion {
  Ring outer;               // counter-clockwise
  std::vector<Ring> holes;  // clockwise
};

// Rectangles that touch along their sides become one; sides closer than a millimetre count as one line. The rectangles must be connected: of
// several separate areas the largest is returned.
RectangleUnion UnionOf(std::span<const Rectangle2d> rectangles);

// Square metres; negative for clockwise rings.
double SignedArea(const Ring& ring);

}  // namespace skyquilt::simulate
