// Points sorted into cubes, for finding those near a place.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "buildings/points/surface_points.h"

namespace skyquilt::buildings {

class PointGrid {
 public:
  // chosen: indices into the cloud; refers to the cloud and to them. cell_m: the largest reach of Near.
  PointGrid(const PointCloud& cloud, std::span<const uint32_t> chosen, double cell_m);

  // Places in `chosen` of at most `most` points nearest to a point of it (the point itself first) within reach_m, nearest first, ties by place.
  // reach_m must not exceed cell_m. Reuses the memory of `near`.
  struct Found {
    float squared_m2;
    uint32_t place;
    auto operator<=>(const Found&) const = default;
  };
  void Near(uint32_t place, double reach_m, size_t most, std::vector<Found>* near) const;

 private:
  using Key = uint64_t;
  Eigen::Vector3i CellOf(const Eigen::Vector3f& position) const;
  static Key KeyOf(const Eigen::Vector3i& cell);

  const PointCloud& cloud_;
  std::span<const uint32_t> chosen_;
  double cell_m_;
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();
  std::vector<Key> key_;         // of filled cubes, rising
  std::vector<uint32_t> first_;  // of each cube and of the end, in place_
  std::vector<uint32_t> place_;  // places in chosen, cube by cube
};

}  // namespace skyquilt::buildings
