// From a Manhattan shape to closed solids: roof facets are cut where another part's roof is higher, then extruded to the ground.
#pragma once

#include <span>
#include <vector>

#include "buildings/building.h"
#include "buildings/geometry/polygon.h"
#include "buildings/solids/solid.h"

namespace skyquilt::buildings {

// A piece of roof: a polygon in u, v and its plane z = slope . uv + offset (ENU height). part: of the shape.
struct RoofFacet {
  Polygon outline;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double offset = 0.0;
  int part = 0;

  double HeightAt(const Eigen::Vector2d& uv) const { return slope.dot(uv) + offset; }
};
// Facets of the upper envelope of all parts, over the walls' rectangles; together they cover the footprint once. Slivers below 0.01 m2 go to a
// neighbour.
std::vector<RoofFacet> RoofFacets(const Shape& shape);
// Outline of the union of all walls, ENU. More than one polygon when the parts do not touch.
std::vector<Polygon> Footprints(const Shape& shape);

// The solid between ground_z and the facets. Facets that meet at different heights are joined by vertical walls; vertices are inserted where edges of
// neighbours end or cross, so that each edge is used once in each direction. Coordinates are rounded to millimetres. The result may be invalid (for
// instance when two high parts touch at a corner only): ask CheckSolid. Facets: of one connected footprint. Without facets, or when
// a height is no number: an empty solid.
Solid ExtrudeFacets(const Shape& shape, std::span<const RoofFacet> facets);
// A block: the footprint between two heights. Holes become courtyards, drawn back by 1 cm where they touch another ring in a vertex. An empty solid
// as above.
Solid ExtrudeBlock(const Polygon& footprint_enu, double ground_z, double top_z);

// What is wrong with a solid, by the codes of val3dity (https://val3dity.readthedocs.io/errors) at its tolerances: 101 too few points, 102
// consecutive points same, 104 ring crosses itself or has no area, 201 rings of a face cross, 203 not planar (more than 0.01 m), 204 normals of the
// face's triangles deviate (more than 20 degrees), 206 hole outside, 207 holes nested, 208 hole runs like the outer ring, 301 too few faces, 302
// shell not closed, 303 non-manifold vertex, 304 non-manifold edge, 305 several components, 306 faces cross, 307 wrong orientation of a face, 309
// vertex without face, 405 all faces look inwards, 902 no numbers; and one of our own: vertices nearer than 1 mm. Shells are looked at when all faces
// are right, and crossings when the shell is. Empty: valid.
inline constexpr int kNearVertices = 1;
struct SolidProblem {
  int code = 0;
  std::string text;  // one sentence with the face or vertex
};
std::vector<SolidProblem> CheckSolid(const Solid& solid);

}  // namespace skyquilt::buildings
