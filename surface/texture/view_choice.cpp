#include "surface/texture/view_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr int kBlockTexels = 8;  // sides of the blocks that share a view
constexpr size_t kTriedViews = 24;
constexpr int64_t kBlocksPerTask = 64;

// Texels of a block, and the one that stands for it.
struct TexelBlock {
  std::vector<size_t> texel;
  size_t middle = 0;
};

std::vector<TexelBlock> BlocksOf(const AtlasLayout& layout, const AtlasTexels& texels) {
  std::vector<TexelBlock> blocks;
  std::vector<TexelBlock> grid;
  std::vector<int> nearest;  // of the block's middle, in half texels along the longer axis
  for (size_t c = 0; c < layout.charts.size(); ++c) {
    const Eigen::Vector2i n = (layout.charts[c].size.array() + (kBlockTexels - 1)) / kBlockTexels;
    grid.assign(static_cast<size_t>(n.x()) * static_cast<size_t>(n.y()), {});
    nearest.assign(grid.size(), 0);
    for (size_t i = texels.first[c]; i < texels.first[c + 1]; ++i) {
      const int x = texels.texel[i].x - layout.corner[c].x();
      const int y = texels.texel[i].y - layout.corner[c].y();
      const size_t b = static_cast<size_t>(y / kBlockTexels) * static_cast<size_t>(n.x()) + static_cast<size_t>(x / kBlockTexels);
      const int distance = std::abs(2 * (x % kBlockTexels) + 1 - kBlockTexels) + std::abs(2 * (y % kBlockTexels) + 1 - kBlockTexels);
      if (grid[b].texel.empty() || distance < nearest[b]) {
        nearest[b] = distance;
        grid[b].middle = i;
      }
      grid[b].texel.push_back(i);
    }
    for (TexelBlock& block : grid) {
      if (!block.texel.empty()) blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

class ViewChooser {
 public:
  ViewChooser(std::span<const DepthView> views, double tolerance_m) : views_(views), tolerance_m_(tolerance_m) {
    for (const DepthView& view : views) centre_.push_back(view.pose.Centre());
  }

  int32_t Best(const Eigen::Vector3d& x, const Eigen::Vector3d& normal) const {
    std::vector<std::pair<double, int32_t>> photos;  // score, view
    std::vector<std::pair<double, int32_t>> virtuals;
    for (size_t v = 0; v < views_.size(); ++v) {
      const Eigen::Vector3d to_view = centre_[v] - x;
      const double distance2 = to_view.squaredNorm();
      const double along = normal.dot(to_view);
      if (!(along > 0.0) || !(along * along >= kLeastViewCosine * kLeastViewCosine * distance2)) continue;
      if (!views_[v].pose.Project(x)) continue;
      (views_[v].pose.photo >= 0 ? photos : virtuals).emplace_back(along / distance2, static_cast<int32_t>(v));
    }
    const int32_t photo = BestSeeing(photos, x);
    return photo >= 0 ? photo : BestSeeing(virtuals, x);
  }

 private:
  int32_t BestSeeing(std::vector<std::pair<double, int32_t>>& candidates, const Eigen::Vector3d& x) const {
    const size_t n = std::min(candidates.size(), kTriedViews);
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(n), candidates.end(),
                      [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    for (size_t i = 0; i < n; ++i) {
      if (Sees(views_[static_cast<size_t>(candidates[i].second)], x, tolerance_m_)) return candidates[i].second;
    }
    return -1;
  }

  std::span<const DepthView> views_;
  std::vector<Eigen::Vector3d> centre_;
  double tolerance_m_;
};

}  // namespace

bool MayShow(const ViewPose& pose, const Eigen::Vector3d& centre, double radius_m) {
  const Eigen::Vector3d x = pose.cam_from_enu * centre;
  if (!(x.z() > -radius_m)) return false;
  // Distance to the planes through the camera and the borders of the picture, positive inside.
  const auto inside = [&](double across, double from_axis) {
    return (pose.focal_px * across + from_axis * x.z()) / std::hypot(pose.focal_px, from_axis) >= -radius_m;
  };
  return inside(x.x(), pose.cx) && inside(-x.x(), pose.width - pose.cx) && inside(x.y(), pose.cy) && inside(-x.y(), pose.height - pose.cy);
}

bool Sees(const DepthView& view, const Eigen::Vector3d& x_in_enu, double tolerance_m) {
  const std::optional<Eigen::Vector2d> pixel = view.pose.Project(x_in_enu);
  if (!pixel) return false;
  const size_t i = static_cast<size_t>(pixel->y()) * static_cast<size_t>(view.pose.width) + static_cast<size_t>(pixel->x());
  if (i >= view.depth_m.size()) return false;
  const double distance = (view.pose.cam_from_enu * x_in_enu).norm();
  return std::abs(static_cast<double>(view.depth_m[i]) - distance) < tolerance_m;
}

std::vector<int32_t> ChooseViews(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels, std::span<const DepthView> views,
                                 double tolerance_m, base::ThreadPool& threads) {
  std::vector<int32_t> chosen(texels.texel.size(), -1);
  const std::vector<TexelBlock> blocks = BlocksOf(layout, texels);
  const ViewChooser chooser(views, tolerance_m);
  const auto n_blocks = static_cast<int64_t>(blocks.size());
  threads.ParallelFor((n_blocks + kBlocksPerTask - 1) / kBlocksPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t b = task * kBlocksPerTask; b < std::min(n_blocks, (task + 1) * kBlocksPerTask); ++b) {
      const TexelBlock& block = blocks[static_cast<size_t>(b)];
      const int32_t best = chooser.Best(texels.PositionOf(geometry, block.middle), texels.NormalOf(geometry, block.middle));
      for (const size_t i : block.texel) chosen[i] = best;
    }
  });
  return chosen;
}

}  // namespace skyquilt::surface
