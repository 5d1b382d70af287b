// Exact pictures of depth of planes, spheres and boxes, and checks of the meshes fused from them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "surface/mesh.h"
#include "surface/views/depth_views.h"

namespace skyquilt::surface::test {

struct Plane {
  Eigen::Vector3d point, normal;
};
struct Sphere {
  Eigen::Vector3d centre;
  double radius;
};
struct Box {
  Eigen::Vector3d min, max;
};
// Metres, ENU.
struct AnalyticScene {
  std::vector<Plane> planes;
  std::vector<Sphere> spheres;
  std::vector<Box> boxes;

  // Distance to the nearest surface; inside and outside count alike.
  double Distance(const Eigen::Vector3d& x) const;
};

// Owns the pixels of its views.
struct Pictures {
  std::vector<std::vector<float>> depth_m;
  std::vector<std::vector<uint8_t>> cosine;
  std::vector<DepthView> views;

  // Looks from a place towards a target; `photo` as in ViewPose.
  void Add(const AnalyticScene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& target, double focal_px, int size_px, int photo);
};

// Directions that are spread evenly over the sphere, or its upper half.
std::vector<Eigen::Vector3d> EvenDirections(int n, bool upper_half);

struct MeshCheck {
  int boundary_edges = 0;
  int bad_edges = 0;                   // of more than two triangles, or of two that disagree about the sides
  std::vector<uint32_t> bad_vertices;  // whose triangles are not one fan
  int degenerate = 0;                  // triangles without area
};
MeshCheck CheckMesh(const Mesh& mesh);

// Triangles as keys, beginning with the smallest: independent of the order of vertices.
std::set<std::array<uint64_t, 3>> KeyTriangles(const Mesh& mesh);
double SignedVolume(const Mesh& mesh);  // positive when a closed mesh is counter-clockwise seen from outside

}  // namespace skyquilt::surface::test
