// Plants and trees of a simulated tidal flat: a salt marsh on the sand that stays above high water, with a few trees on its highest ground.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "simulate/surface.h"
#include "simulate/tree.h"

namespace skyquilt::simulate {

class SaltMarsh {
 public:
  // min, max: corners of the place, ENU metres. ground_z: height of the sand. water_z_m: of the channels.
  SaltMarsh(const Eigen::Vector2d& min, const Eigen::Vector2d& max, const std::function<double(const Eigen::Vector2d&)>& ground_z, double water_z_m,
            uint32_t seed);

  // Whether plants cover the sand there.
  bool Covers(const Eigen::Vector3f& position) const;
  // The sand's surface, or that of the plants on it. hit: on the ground.
  Surface Over(const Surface& sand, const Hit& hit) const;
  const std::vector<Tree>& trees() const { return trees_; }

 private:
  float water_z_m_;
  uint32_t seed_;
  std::vector<Tree> trees_;
};

}  // namespace skyquilt::simulate
