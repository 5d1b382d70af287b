// What of a building's model can be seen in points: faces above the ground, edges and corners, with the roof continued over its overhang.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "buildings/building.h"

namespace skyquilt::buildings {

// A planar polygon in space with holes. Distances are to the polygon, not to its plane.
class FlatPolygon {
 public:
  // rings: the outer one and holes, in one plane. normal: of length 1.
  FlatPolygon(std::vector<std::vector<Eigen::Vector3d>> rings, const Eigen::Vector3d& normal);

  const Eigen::Vector3d& normal() const { return normal_; }
  const std::vector<std::vector<Eigen::Vector3d>>& rings() const { return rings_; }
  // Infinite beyond `reach` from the plane.
  double Distance(const Eigen::Vector3d& x, double reach) const;

 private:
  std::vector<std::vector<Eigen::Vector3d>> rings_;
  std::vector<std::vector<Eigen::Vector2d>> flat_;  // the same along two axes of the plane
  Eigen::Vector3d origin_, normal_, axis_s_, axis_t_;
};

struct ModelFace {
  FaceKind kind = FaceKind::kWall;  // wall or roof
  FlatPolygon polygon;
};
// below_roof: at the walls, under an overhang, where points of the roof's upper side lie as on any other place of the roof.
struct ModelEdge {
  Eigen::Vector3d a, b;
  bool below_roof = false;
};
struct ModelCorner {
  Eigen::Vector3d place;
  bool below_roof = false;
};

struct ModelParts {
  std::vector<ModelFace> faces;
  std::vector<ModelEdge> edges;      // of faces that meet at more than 20 degrees; none at the ground
  std::vector<ModelCorner> corners;  // where at least three faces meet at more than 20 degrees, the ground not counted
};
// Of the lod22 solid. The overhangs of pitched roofs become faces, with edges and corners where they end: a real roof has these there.
ModelParts PartsOf(const Building& building);

double DistanceToSegment(const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b);

}  // namespace skyquilt::buildings
