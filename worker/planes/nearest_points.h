// The nearest of many points, by a k-d tree.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::worker {

// Constant after construction, so any number of threads may search.
class NearestPoints {
 public:
  // Any frame. Coordinates must be finite.
  explicit NearestPoints(const std::vector<Eigen::Vector3d>& points);

  // Writes the indices of the points nearest to x, the nearest first, as many as `nearest` holds or as there are points. Returns their number.
  size_t Find(const Eigen::Vector3d& x, std::span<int32_t> nearest) const;

 private:
  struct Node {
    Eigen::Vector3d x;
    int32_t index = 0;  // of the point
    int32_t axis = 0;   // along which it parts the others of its range
  };
  struct Search;

  void Build(size_t begin, size_t end);
  void Visit(size_t begin, size_t end, Search& search) const;

  std::vector<Node> nodes_;  // the root of every range of nodes is its middle one
};

}  // namespace skyquilt::worker
