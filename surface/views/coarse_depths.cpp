#include "surface/views/coarse_depths.h"

#include <algorithm>
#include <cmath>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr double kLeastCosine = 0.1;  // limits what a pixel seen at a flat angle may stand for
constexpr int64_t kSamplesPerTask = 1024;

double CosineFromByte(uint8_t cosine) {
  return std::max(kLeastCosine, cosine / 255.0);
}

}  // namespace

CoarseDepths::CoarseDepths(int64_t pixels, double limit_bytes) {
  constexpr double kPixelBytes = sizeof(float) + sizeof(uint8_t);
  step_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(pixels) * kPixelBytes / limit_bytes))));
}

void CoarseDepths::Add(const DepthView& view) {
  Picture picture;
  const auto kept = [this](int size) { return size > step_ / 2 ? (size - step_ / 2 - 1) / step_ + 1 : 0; };
  picture.width = kept(view.pose.width);
  picture.height = kept(view.pose.height);
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const auto x = static_cast<size_t>(column * step_ + step_ / 2), y = static_cast<size_t>(row * step_ + step_ / 2);
      const size_t pixel = y * static_cast<size_t>(view.pose.width) + x;
      picture.depth_m.push_back(view.depth_m[pixel]);
      picture.cosine.push_back(view.cosine[pixel]);
    }
  }
  poses_.push_back(view.pose);
  pictures_.push_back(std::move(picture));
}

std::optional<CoarseDepths::Look> CoarseDepths::LookAtPlace(size_t view, const Eigen::Vector3d& x_in_enu) const {
  const ViewPose& pose = poses_[view];
  const Picture& picture = pictures_[view];
  const std::optional<Eigen::Vector2d> at = pose.Project(x_in_enu);
  if (!at || picture.depth_m.empty()) return std::nullopt;
  const int column = std::min(static_cast<int>(at->x()) / step_, picture.width - 1),
            row = std::min(static_cast<int>(at->y()) / step_, picture.height - 1);
  const size_t i = static_cast<size_t>(row) * static_cast<size_t>(picture.width) + static_cast<size_t>(column);
  const auto depth = static_cast<double>(picture.depth_m[i]);
  if (std::isnan(depth)) return std::nullopt;
  // The kept pixel is beside the place: on a slope its depth differs by that alone.
  const double offset_m = (*at - Eigen::Vector2d(PositionOf(column), PositionOf(row))).norm() * depth / pose.focal_px;
  const double cosine = CosineFromByte(picture.cosine[i]);
  const double slope = std::sqrt(1.0 - std::min(1.0, cosine * cosine)) / cosine;
  return Look{(x_in_enu - pose.Centre()).norm() - depth, offset_m * slope};
}

bool CoarseDepths::Sees(size_t view, const Eigen::Vector3d& x_in_enu, double tolerance_m) const {
  const std::optional<Look> look = LookAtPlace(view, x_in_enu);
  return look && std::abs(look->behind_m) < tolerance_m + look->slack_m;
}

std::vector<SurfaceSample> CoarseDepths::Samples(int64_t max_samples, double tolerance_m, base::ThreadPool& threads) const {
  double kept = 0.0;
  for (const Picture& picture : pictures_) kept += static_cast<double>(picture.depth_m.size());
  const int stride = std::max(1, static_cast<int>(std::ceil(std::sqrt(kept / static_cast<double>(max_samples)))));
  std::vector<SurfaceSample> samples;
  for (size_t v = 0; v < pictures_.size(); ++v) {
    const Picture& picture = pictures_[v];
    const ViewPose& pose = poses_[v];
    if (picture.depth_m.empty()) continue;
    // Of small pictures at least one pixel.
    for (int row = std::min(stride / 2, picture.height - 1); row < picture.height; row += stride) {
      for (int column = std::min(stride / 2, picture.width - 1); column < picture.width; column += stride) {
        const size_t i = static_cast<size_t>(row) * static_cast<size_t>(picture.width) + static_cast<size_t>(column);
        const auto depth = static_cast<double>(picture.depth_m[i]);
        if (std::isnan(depth)) continue;
        const double side_m = depth / pose.focal_px * step_ * stride;
        samples.push_back({.position = pose.Centre() + depth * pose.DirectionAt(PositionOf(column), PositionOf(row)),
                           .area_m2 = side_m * side_m / CosineFromByte(picture.cosine[i]),
                           .cosine = CosineFromByte(picture.cosine[i]),
                           .view = v});
      }
    }
  }
  const auto n_samples = static_cast<int64_t>(samples.size());
  threads.ParallelFor((n_samples + kSamplesPerTask - 1) / kSamplesPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    for (int64_t s = task * kSamplesPerTask; s < std::min(n_samples, (task + 1) * kSamplesPerTask); ++s) {
      const auto i = static_cast<size_t>(s);
      for (size_t v = 0; v < pictures_.size(); ++v) {
        if (v != samples[i].view && Sees(v, samples[i].position, tolerance_m)) ++samples[i].views;
      }
    }
  });
  return samples;
}

}  // namespace skyquilt::surface
