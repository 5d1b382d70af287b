#include "surface/texture/texture_baker.h"

#include <limits>

#include "surface/texture/bake_tile.h"
#include "surface/texture/view_choice.h"

namespace skyquilt::surface {
namespace {

// Middle and half diagonal of the box around the vertices; a radius below 0 when there are none.
struct BoundingBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius_m = -1.0;
};

BoundingBall BallOf(const Mesh& mesh) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high = -low;
  for (const Eigen::Vector3d& x : mesh.position) {
    if (!x.allFinite()) continue;
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  if (!low.allFinite()) return {};
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

}  // namespace

TextureBaker::TextureBaker(const SurfaceInput& input, const DepthViews& views, double voxel_m) : input_(input), views_(views), voxel_m_(voxel_m) {}

BakedTile TextureBaker::Bake(const MeshTile& mesh, const BakeOptions& options, base::ThreadPool& threads) const {
  std::vector<DepthView> near;
  const BoundingBall ball = BallOf(mesh.mesh);
  for (size_t v = 0; v < views_.size() && ball.radius_m >= 0.0; ++v) {
    if (MayShow(views_.pose(v), ball.centre, ball.radius_m)) near.push_back(views_[v]);
  }
  return BakeTile(mesh, near, {input_.caster, voxel_m_, input_.survey, input_.photos}, options, threads);
}

}  // namespace skyquilt::surface
