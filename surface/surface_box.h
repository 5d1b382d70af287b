// Where a scene has surface that is worth meshing: its blocks with their margins, in which fields are trained too. Beyond them there is only the
// coarse context. Survey ENU, metres.
#pragma once

#include <Eigen/Core>

#include "core/scene/scene.h"

namespace skyquilt::surface {

struct SurfaceBox {
  Eigen::Vector3d min_enu, max_enu;
};

// The box around all blocks; that of the scene where it has none.
inline SurfaceBox SurfaceBoxOf(const scene::SceneInfo& info) {
  SurfaceBox box{info.min_enu, info.max_enu};
  for (const scene::SceneBlock& block : info.blocks) {
    box.min_enu = box.min_enu.cwiseMin(block.TrainMin());
    box.max_enu = box.max_enu.cwiseMax(block.TrainMax());
  }
  return box;
}

}  // namespace skyquilt::surface
