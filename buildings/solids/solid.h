// A closed solid of planar faces with meanings, as CityJSON wants it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace skyquilt::buildings {

enum class FaceKind : uint8_t { kGround, kWall, kRoof };

// Rings index into Solid::vertex, without repeating the first. Outer ring counter-clockwise seen from outside the solid, holes clockwise.
struct Face {
  FaceKind kind = FaceKind::kWall;
  std::vector<uint32_t> outer;
  std::vector<std::vector<uint32_t>> holes;
};

// One closed shell. Vertices are distinct and at least 1 mm apart.
struct Solid {
  std::vector<Eigen::Vector3d> vertex;  // ENU, metres
  std::vector<Face> face;

  bool Empty() const { return face.empty(); }
};

// Cubic metres by the divergence theorem; negative when faces look inwards.
double Volume(const Solid& solid);
// Square metres of the faces of this kind.
double Area(const Solid& solid, FaceKind kind);

// Triangles of all faces, counter-clockwise from outside, and the face of each. Throws nothing: a face that cannot be triangulated is left out.
struct SolidTriangles {
  std::vector<std::array<uint32_t, 3>> triangle;  // into Solid::vertex
  std::vector<uint32_t> face;                     // of each triangle
};
SolidTriangles Triangulate(const Solid& solid);

}  // namespace skyquilt::buildings
