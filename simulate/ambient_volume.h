// Ambient light: what a surface receives from the sky and from the ground around it, without the sun. Stored as a grid of first-order spherical
// harmonics, computed once per world and cheap to look up. Sources: irradiance volume, Greger et al. 1998; cosine convolution, Ramamoorthi and
// Hanrahan 2001.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/raytrace/traced_scene.h"
#include "simulate/sky.h"
#include "simulate/tagged_mesh.h"

namespace skyquilt::simulate {

class AmbientVolume {
 public:
  // Grid over the mesh's bounds with cells of voxel_m metres.
  AmbientVolume(const Mesh& mesh, const raytrace::TracedScene& scene, const Sky& sky, float voxel_m, base::ThreadPool& threads);

  // Ambient irradiance / pi on a surface at `position` (ENU metres) with this unit normal; outside the grid that of its border.
  Eigen::Vector3f Irradiance(const Eigen::Vector3f& position, const Eigen::Vector3f& normal) const;

 private:
  // Mean radiance and its gradient along x, y, z, per colour; weight near 0 inside solids.
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
