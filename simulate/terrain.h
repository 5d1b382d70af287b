// Ground of a simulated place: a grid of heights over a rectangle, interpolated bilinearly. ENU metres.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

class Terrain {
 public:
  // Samples `height` (metres at east, north) every step_m; the last row and column are at or beyond `max`.
  Terrain(const Eigen::Vector2d& min, const Eigen::Vector2d& max, double step_m, const std::function<double(double, double)>& height);

  // Outside the rectangle: the height at its edge.
  float Height(float east, float north) const;
  const Eigen::Vector2d& min() const { return min_; }
  const Eigen::Vector2d& max() const { return max_; }
  float lowest() const;
  // Two triangles per cell with smooth normals.
  void AddTo(Mesh& mesh) const;

 private:
  float Node(int i, int j) const { return node_[static_cast<size_t>(j) * static_cast<size_t>(nx_) + static_cast<size_t>(i)]; }
  Eigen::Vector2d min_;
  Eigen::Vector2d max_;
  double step_m_;
  int nx_;
  int ny_;
  std::vector<float> node_;
};

// Gentle hills with wavelengths of 60 to 240 m; heights within about +-1.7 amplitude_m.
double RollingHeight(double east, double north, double amplitude_m, uint32_t seed);

// Rise of a hillside of this slope per metre to the east and to the north; it rises to the north-east.
Eigen::Vector2d HillsideRise(double slope_deg);

}  // namespace skyquilt::simulate
