#include "surface/fusion/bricks.h"

#include <cmath>

#include "core/base/cancel.h"
#include "core/base/random.h"

namespace skyquilt::surface {
namespace {

// Nodes around each point of the ray that are marked too: cells need their far corners, quads the cells around them, and the surface lies between
// rays.
constexpr int kMarkedAround = 2;
// Coordinates are moved by this many voxels, a multiple of the brick, so that they are positive and rounding them down is a plain conversion.
constexpr int kShift = 1 << 23;

// Leaves out most keys that were added shortly before: neighbouring pixels mark the same bricks.
class KeyCollector {
 public:
  void Add(uint64_t key) {
    uint64_t& last = recent_[base::MixBits(key) % recent_.size()];
    if (last == key) return;
    last = key;
    keys_.push_back(key);
  }
  std::vector<uint64_t> Sorted() {
    std::sort(keys_.begin(), keys_.end());
    keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    return std::move(keys_);
  }

 private:
  static constexpr uint64_t kNone = ~uint64_t{0};
  std::vector<uint64_t> recent_ = std::vector<uint64_t>(4096, kNone);
  std::vector<uint64_t> keys_;
};

// The bricks that hold the nodes around a point in voxels; empty when it is not in reach.
LatticeBox BricksAround(const Eigen::Vector3d& point, const LatticeBox& range) {
  LatticeBox bricks;
  for (int axis = 0; axis < 3; ++axis) {
    const double low = kBrickSide * range.min[axis] - kMarkedAround - 2;
    const double high = kBrickSide * range.max[axis] + kMarkedAround + 2;
    if (!(point[axis] > low && point[axis] < high)) return {};
    const int node = static_cast<int>(point[axis] + kShift) - kShift;
    bricks.min[axis] = std::max(BrickOfNode(node - kMarkedAround), range.min[axis]);
    bricks.max[axis] = std::min(BrickOfNode(node + 1 + kMarkedAround) + 1, range.max[axis]);
  }
  return bricks;
}

}  // namespace

LatticeBox BricksOfNodes(const LatticeBox& nodes) {
  LatticeBox bricks;
  for (int axis = 0; axis < 3; ++axis) {
    bricks.min[axis] = BrickOfNode(nodes.min[axis]);
    bricks.max[axis] = BrickOfNode(nodes.max[axis] - 1) + 1;
  }
  return bricks;
}

MetricBox ReachOfBricks(const LatticeBox& bricks, double voxel_m) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kMarkedAround + 2);
  return {(kBrickSide * bricks.min.cast<double>() - margin) * voxel_m, (kBrickSide * bricks.max.cast<double>() + margin) * voxel_m};
}

std::vector<uint64_t> MarkBricks(const ViewCamera& view, const LatticeBox& range, const FuseOptions& options) {
  const PixelRectangle pixels = PixelsOfBox(view, ReachOfBricks(range, options.voxel_m));
  if (pixels.Empty()) return {};
  // Points on the ray, at most half a brick apart, so that the nodes around them join.
  const double truncation_m = options.truncation_voxels * options.voxel_m;
  const int n_steps = std::max(2, static_cast<int>(std::ceil(2.0 * options.truncation_voxels / (0.5 * kBrickSide))));
  const auto n_points = static_cast<size_t>(n_steps) + 1;
  std::vector<LatticeBox> last(n_points);
  KeyCollector keys;
  const Eigen::Vector3d centre = view.centre / options.voxel_m;
  const Eigen::Matrix3d enu_from_camera = view.rotation.transpose() / options.voxel_m;
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    const float* depth = view.depth_m + static_cast<size_t>(y) * static_cast<size_t>(view.width);
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      if (!IsDepth(depth[x])) continue;
      const Eigen::Vector3d in_camera((x + 0.5 - view.cx) / view.focal_px, (y + 0.5 - view.cy) / view.focal_px, 1.0);
      const Eigen::Vector3d direction = enu_from_camera * (in_camera / in_camera.norm());
      for (size_t i = 0; i < n_points; ++i) {
        const double t_m = static_cast<double>(depth[x]) + truncation_m * (2.0 * static_cast<double>(i) / n_steps - 1.0);
        if (!(t_m > 0.0)) continue;
        const LatticeBox bricks = BricksAround(centre + t_m * direction, range);
        if (IsEmptyBox(bricks) || (bricks.min == last[i].min && bricks.max == last[i].max)) continue;
        last[i] = bricks;
        for (int bz = bricks.min.z(); bz < bricks.max.z(); ++bz) {
          for (int by = bricks.min.y(); by < bricks.max.y(); ++by) {
            for (int bx = bricks.min.x(); bx < bricks.max.x(); ++bx) keys.Add(BrickKey(bx, by, bz));
          }
        }
      }
    }
  }
  return keys.Sorted();
}

Bricks MarkAllBricks(std::span<const ViewCamera> views, const LatticeBox& range, const FuseOptions& options, base::ThreadPool& threads) {
  std::vector<std::vector<uint64_t>> of_view(views.size());
  threads.ParallelFor(static_cast<int64_t>(views.size()), [&](int64_t view, int) {
    base::ThrowIfCancelled();
    of_view[static_cast<size_t>(view)] = MarkBricks(views[static_cast<size_t>(view)], range, options);
  });
  Bricks bricks;
  for (std::vector<uint64_t>& keys : of_view) {
    bricks.key.insert(bricks.key.end(), keys.begin(), keys.end());
    keys = {};
  }
  std::sort(bricks.key.begin(), bricks.key.end());
  bricks.key.erase(std::unique(bricks.key.begin(), bricks.key.end()), bricks.key.end());
  bricks.key.shrink_to_fit();
  return bricks;
}

}  // namespace skyquilt::surface
