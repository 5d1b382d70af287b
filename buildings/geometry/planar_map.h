// The plane cut along segments into faces that meet edge to edge, with a label for each: the topology of roofs and footprints.
// Faces are found from the segments alone, so that every edge has exactly one face on each side whatever rounding does.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/geometry/polygon.h"

namespace skyquilt::buildings {

struct Segment {
  Eigen::Vector2d a, b;
};

// Faces of one label that are connected by edges, with the rings around them. Rings pass a vertex once and may touch each other at vertices.
struct MapRegion {
  int label = 0;
  std::vector<uint32_t> outer;               // counter-clockwise, vertices of the map
  std::vector<std::vector<uint32_t>> holes;  // clockwise
};

// Half-edges come in pairs: Twin(h) runs the other way. The face of a half-edge is on its left.
class PlanarMap {
 public:
  // Points nearer than snap_m are one vertex, at the place of the first; an edge that passes a vertex nearer than snap_m goes through it. Segments of
  // length 0 are vertices to be inserted into edges. Segments with ends that are no numbers are left out. For up to some thousand segments: O(n^2).
  PlanarMap(std::span<const Segment> segments, double snap_m);

  size_t Vertices() const { return vertex_.size(); }
  const Eigen::Vector2d& Vertex(uint32_t v) const { return vertex_[v]; }
  uint32_t HalfEdges() const { return static_cast<uint32_t>(from_.size()); }
  uint32_t From(uint32_t h) const { return from_[h]; }
  uint32_t To(uint32_t h) const { return from_[Twin(h)]; }
  static uint32_t Twin(uint32_t h) { return h ^ 1U; }
  int FaceOf(uint32_t h) const { return face_[h]; }  // -1: the outside
  int Faces() const { return n_faces_; }
  // A place well inside each face.
  std::vector<Eigen::Vector2d> PointsInFaces() const;
  std::vector<double> FaceAreas() const;

  // label: of each face; negative: no region, like the outside. straight_m: vertices where only two regions meet and the border goes straight on are
  // left out, up to this distance from the line; negative: never. Sorted by label, then as found.
  std::vector<MapRegion> Regions(std::span<const int> label, double straight_m) const;
  // The label on the left of a half-edge; all that is outside is -1.
  int LabelOf(uint32_t h, std::span<const int> label) const;
  // Connected faces of equal label have the same number, from 0. Negative labels too.
  std::vector<int> Components(std::span<const int> label) const;
  Polygon OutlineOf(const MapRegion& region) const;

 private:
  std::vector<std::vector<uint32_t>> RingsOfFaces();  // sets next_
  void FindFaces();

  std::vector<Eigen::Vector2d> vertex_;
  std::vector<uint32_t> from_;  // of each half-edge
  std::vector<uint32_t> next_;  // around the face
  std::vector<int> face_;
  int n_faces_ = 0;
};

}  // namespace skyquilt::buildings
