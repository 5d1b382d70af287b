#include "surface/texture/view_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr size_t kTriedViews = 24;
constexpr int64_t kBlocksPerTask = 64;

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
        grid[b].middle = static_cast<uint32_t>(i);
      }
      grid[b].texel.push_back(static_cast<uint32_t>(i));
    }
    for (TexelBlock& block : grid) {
      if (!block.texel.empty()) blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

class ViewChooser {
 public:
  explicit ViewChooser(std::span<const DepthView> views) : views_(views) {
    for (const DepthView& view : views) centre_.push_back(view.pose.Centre());
  }

  std::array<int32_t, kKeptViews> Best(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, double tolerance_m) const {
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
    std::array<int32_t, kKeptViews> best;
    best.fill(-1);
    if (FindSeeing(photos, x, tolerance_m, best) == 0) FindSeeing(virtuals, x, tolerance_m, std::span(best).first(1));
    return best;
  }

 private:
  size_t FindSeeing(std::vector<std::pair<double, int32_t>>& candidates, const Eigen::Vector3d& x, double tolerance_m,
                    std::span<int32_t> best) const {
    const size_t n = std::min(candidates.size(), kTriedViews);
    std::partial_sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(n), candidates.end(),
                      [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
    size_t found = 0;
    for (size_t i = 0; i < n && found < best.size(); ++i) {
      if (Sees(views_[static_cast<size_t>(candidates[i].second)], x, tolerance_m)) best[found++] = candidates[i].second;
    }
    return found;
  }

  std::span<const DepthView> views_;
  std::vector<Eigen::Vector3d> centre_;
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

bool SeesClearly(const DepthView& view, const Eigen::Vector3d& x_in_enu, double tolerance_m) {
  if (!Sees(view, x_in_enu, tolerance_m)) return false;
  const Eigen::Vector2i pixel = view.pose.Project(x_in_enu)->cast<int>();
  const double nearest = (view.pose.cam_from_enu * x_in_enu).norm() - tolerance_m;
  for (int y = std::max(pixel.y() - 1, 0); y <= std::min(pixel.y() + 1, view.pose.height - 1); ++y) {
    for (int x = std::max(pixel.x() - 1, 0); x <= std::min(pixel.x() + 1, view.pose.width - 1); ++x) {
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(view.pose.width) + static_cast<size_t>(x);
      if (static_cast<double>(view.depth_m[i]) < nearest) return false;
    }
  }
  return true;
}

std::vector<TexelBlock> ChooseViews(const TileGeometry& geometry, const AtlasLayout& layout, const AtlasTexels& texels,
                                    std::span<const DepthView> views, double tolerance_m, base::ThreadPool& threads) {
  std::vector<TexelBlock> blocks = BlocksOf(layout, texels);
  const ViewChooser chooser(views);
  const auto n_blocks = static_cast<int64_t>(blocks.size());
  threads.ParallelFor((n_blocks + kBlocksPerTask - 1) / kBlocksPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t b = task * kBlocksPerTask; b < std::min(n_blocks, (task + 1) * kBlocksPerTask); ++b) {
      TexelBlock& block = blocks[static_cast<size_t>(b)];
      const double tolerance = tolerance_m * (geometry.IsFilled(texels.texel[block.middle].triangle) ? kFilledTolerance : 1.0);
      block.view = chooser.Best(texels.PositionOf(geometry, block.middle), texels.NormalOf(geometry, block.middle), tolerance);
    }
  });
  return blocks;
}

}  // namespace skyquilt::surface
