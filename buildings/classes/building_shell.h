// Finds what of a building's model is near a place, by a grid of cells that know the parts within reach.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "buildings/building.h"
#include "buildings/classes/model_parts.h"

namespace skyquilt::buildings {

// Distances are infinite where there is nothing within reach.
struct NearModel {
  double edge_m = std::numeric_limits<double>::infinity();
  double corner_m = std::numeric_limits<double>::infinity();
  double mismatch = std::numeric_limits<double>::infinity();  // of the best face: its distance over reach, plus 1 - cosine of the normals' angle
  FaceKind kind = FaceKind::kWall;                            // of that face
  double agreement = -1.0;                                    // greatest cosine of the angles between the point's normal and those of near faces

  bool Found() const { return std::isfinite(mismatch); }
  void Join(const NearModel& other);
};

class BuildingShell {
 public:
  // The building must outlive it.
  BuildingShell(const Building& building, double reach_m);

  // In plan, all places that are within reach or inside the footprint.
  const Eigen::AlignedBox2d& plan_box() const { return plan_box_; }
  NearModel At(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal) const;
  // Distance from inside the footprint to its border; 0 outside.
  double DepthInside(const Eigen::Vector2d& enu) const;

 private:
  Eigen::AlignedBox3d BoxOf(uint32_t item) const;
  double Distance(uint32_t item, const Eigen::Vector3d& x, double reach) const;
  void FillCells();

  const Building& building_;
  double reach_m_;
  ModelParts parts_;  // as items: faces, then edges, then corners
  uint32_t edges_begin_ = 0, corners_begin_ = 0, items_ = 0;
  Eigen::AlignedBox2d plan_box_;
  Eigen::AlignedBox3d box_;
  double cell_m_ = 1.0;
  Eigen::Array3i size_ = Eigen::Array3i::Zero();
  std::vector<uint32_t> begin_;  // of each cell in cell_items_, and the end
  std::vector<uint32_t> cell_items_;
};

}  // namespace skyquilt::buildings
