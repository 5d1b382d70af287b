// Finds the triangle of a mesh that is nearest to a point, exactly. A tree of bounding boxes instead of a grid, because true surfaces have triangles
// of centimetres beside others of many metres.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace skyquilt::evaluate::surface {

// The point of the triangle a, b, c that is nearest to p. Triangles may have no area.
Eigen::Vector3d NearestOnTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c);

class NearestTriangles {
 public:
  struct Found {
    double distance_m = 0.0;
    Eigen::Vector3d point = Eigen::Vector3d::Zero();  // on the triangle
    uint32_t triangle = 0;
  };

  // Metres in a frame of the caller's choice; both are copied. Coordinates must be finite.
  NearestTriangles(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle);

  // Nothing when no triangle is within limit_m.
  std::optional<Found> Nearest(const Eigen::Vector3d& point, double limit_m) const;

 private:
  struct Node {
    Eigen::Vector3f low, high;
    uint32_t first = 0;  // of a leaf: its first entry of order_; otherwise its second child, the first one follows the node
    uint32_t count = 0;  // triangles of a leaf; 0: not a leaf
  };
  // Makes the subtree of the entries [first, last) of order_.
  void Build(uint32_t first, uint32_t last);
  Eigen::Vector3f Middle(uint32_t triangle) const;

  std::vector<Eigen::Vector3f> position_;
  std::vector<std::array<uint32_t, 3>> triangle_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace skyquilt::evaluate::surface
