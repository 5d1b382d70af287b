// Light of the sky and of the ground at every place, as a grid of first-order spherical harmonics (irradiance volume, Greger et al. 1998;
// cosine convolution, Ramamoorthi and Hanrahan 2001). Computed once per world: smooth, the same from every photo, and cheap to look up.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/raytrace/traced_scene.h"
#include "simulate/mesh.h"
#include "simulate/sky.h"

namespace skyquilt::simulate {

class AmbientVolume {
 public:
  // Grid over the mesh's bounds with cells of voxel_m.
  AmbientVolume(const Mesh& mesh, const raytrace::TracedScene& scene, const Sky& sky, float voxel_m, base::ThreadPool& threads);

  // Irradiance / pi from all but the sun on a surface with this normal; clamped to the grid outside.
  Eigen::Vector3f Irradiance(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;

 private:
  // Mean radiance and its slope along x, y, z, per colour; weight 0 inside solids.
  struct Node {
    Eigen::Matrix<float, 3, 4> harmonics = Eigen::Matrix<float, 3, 4>::Zero();
    float weight = 0.0F;
  };
  Eigen::Vector3f min_;
  float voxel_m_;
  std::array<int, 3> size_{};
  std::vector<Node> node_;
};

}  // namespace skyquilt::simulate
