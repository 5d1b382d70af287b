// All buildings of a survey, found by place.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/classes/building_shell.h"
#include "core/base/thread_pool.h"

namespace skyquilt::buildings {

class BuildingIndex {
 public:
  // The buildings must outlive it. Throws base::Interrupted.
  BuildingIndex(std::span<const Building> buildings, double reach_m, base::ThreadPool& threads);

  struct Found {
    NearModel near;         // of all buildings
    double inside_m = 0.0;  // distance to the border of the footprint that the place is in; 0 outside all
  };
  Found At(const Eigen::Vector3d& x_in_enu, const Eigen::Vector3d& normal) const;

 private:
  std::vector<BuildingShell> shells_;
  // Squares in plan, with the buildings that reach into them.
  Eigen::AlignedBox2d box_;
  double cell_m_ = 1.0;
  Eigen::Array2i size_ = Eigen::Array2i::Zero();
  std::vector<std::vector<uint32_t>> cells_;
};

}  // namespace skyquilt::buildings
