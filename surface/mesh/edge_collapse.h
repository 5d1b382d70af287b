// Removes vertices of a mesh one by one, each moved along an edge onto a neighbour, the cheapest first. See Simplify for what is promised.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <queue>
#include <vector>

#include "surface/mesh.h"
#include "surface/mesh/quadric.h"

namespace skyquilt::surface {

class EdgeCollapse {
 public:
  // Keeps a reference to the mesh.
  explicit EdgeCollapse(const Mesh& mesh);
  // Removes what can be removed with an error of at most max_error_m. Returns the largest error made.
  double Run(double max_error_m);
  // The triangles that are left, with the indices of vertices of the mesh, in its order.
  std::vector<Triangle> Triangles() const;

 private:
  // Corner 3 t + k is vertex k of triangle t.
  struct Step {
    double order = 0.0;  // smaller ones come first
    double error2 = 0.0;
    uint32_t to = 0;
  };
  struct Entry {
    double order = 0.0;
    uint32_t vertex = 0, version = 0;
    bool operator<(const Entry& other) const { return order != other.order ? order > other.order : vertex > other.vertex; }  // for a queue
  };

  // Calls visit(corner) for the triangles at a vertex that are left, and forgets the others.
  template <typename Visitor>
  void ForEachCorner(uint32_t vertex, const Visitor& visit);
  uint32_t Next(uint32_t corner) const { return triangle_[corner / 3][(corner % 3 + 1) % 3]; }
  const Eigen::Vector3d& At(uint32_t vertex) const { return position_[vertex]; }
  bool IsLocked(uint32_t vertex);
  void GatherRing(uint32_t vertex);
  Step StepTo(uint32_t from, uint32_t to) const;
  void Enqueue(uint32_t vertex);
  bool KeepsTopology(uint32_t from, uint32_t to);
  bool KeepsShape(uint32_t from, uint32_t to) const;
  bool MayMove(uint32_t corner, uint32_t to) const;
  void Collapse(uint32_t from, uint32_t to);

  const Mesh& mesh_;
  double max_error2_ = 0.0;
  std::vector<Eigen::Vector3d> position_;  // relative to the middle, which keeps the digits of quadrics
  std::vector<Triangle> triangle_;
  std::vector<uint8_t> alive_;                 // per triangle
  std::vector<Eigen::Vector3f> first_normal_;  // per triangle: of the triangle of the mesh that it comes from
  std::vector<uint32_t> first_corner_;         // per vertex: head of the list of its corners
  std::vector<uint32_t> next_corner_;          // per corner: next one in that list
  std::vector<Quadric> quadric_;
  std::vector<uint8_t> locked_;
  std::vector<uint32_t> version_;  // per vertex: of its valid entry in the queue
  std::priority_queue<Entry> queue_;
  std::vector<uint32_t> mark_;  // per vertex: the last number of a search that met it
  uint32_t search_ = 0;
  // Of the vertex given to GatherRing.
  std::vector<uint32_t> corners_, ring_;
};

}  // namespace skyquilt::surface
