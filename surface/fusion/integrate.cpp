#include "surface/fusion/integrate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/cancel.h"

namespace skyquilt::surface {
namespace {

constexpr int kBricksPerTask = 16;
constexpr float kUnsureWeight = 0.1F;
constexpr float kCosineUnit = 1.0F / 255.0F;  // of the bytes that pictures keep

struct Weighting {
  float truncation_m;
  float lowest_cosine;
  float behind;  // 1 / metres over which the weight falls to 0 behind the surface
  float area;    // weights are cosine * area / distance^2; any constant gives the same mean, this one keeps them near 1
};

// Sums of one brick; arrays of its nodes.
struct BrickSums {
  float* psi;
  float* weight;
  uint8_t* views;
  uint8_t* photos;
};

void CountUp(uint8_t* count, int by) {
  *count = static_cast<uint8_t>(std::min(*count + by, static_cast<int>(std::numeric_limits<uint8_t>::max())));
}

struct Lookup {
  float depth_m;
  bool sure;
};

// Depth at an image position: bilinear where the four pixels around it show one surface, otherwise that of the nearest pixel. That is not sure,
// because the outline of what is in front may be up to half a pixel away: where a view looks along a wall, pixels beside it would hollow it out.
Lookup DepthAt(const ViewCamera& view, float u, float v, float nearest, float free_depth_m, const Weighting& weighting) {
  const int x = static_cast<int>(u + 0.5F) - 1;
  const int y = static_cast<int>(v + 0.5F) - 1;
  if (x < 0 || y < 0 || x + 1 >= view.width || y + 1 >= view.height) return {nearest, true};
  const size_t upper = static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
  const size_t lower = upper + static_cast<size_t>(view.width);
  const float* depth = view.depth_m;
  const float d00 = depth[upper], d10 = depth[upper + 1], d01 = depth[lower], d11 = depth[lower + 1];
  if (!(IsDepth(d00) && IsDepth(d10) && IsDepth(d01) && IsDepth(d11))) return {nearest, false};
  const float least = std::min(std::min(d00, d10), std::min(d01, d11));
  // All of them see nothing before this depth.
  if (least > free_depth_m) return {nearest, true};
  const float difference = std::max(std::max(d00, d10), std::max(d01, d11)) - least;
  if (!(difference < weighting.truncation_m)) {
    // Pixels far apart in depth may still be one surface that is seen at a flat angle: allow twice the slope between neighbours that it has if all
    // four see it at that angle.
    const uint8_t* c = view.cosine;
    const uint8_t steepest = std::max(std::max(c[upper], c[upper + 1]), std::max(c[lower], c[lower + 1]));
    const float cosine = std::max(static_cast<float>(steepest) * kCosineUnit, weighting.lowest_cosine);
    const float slope = nearest / static_cast<float>(view.focal_px) * std::sqrt(std::max(0.0F, 1.0F - cosine * cosine)) / cosine;
    if (!(difference < 2.0F * slope)) return {nearest, false};
  }
  const float ax = u - 0.5F - static_cast<float>(x);
  const float ay = v - 0.5F - static_cast<float>(y);
  return {(1.0F - ay) * (d00 + ax * (d10 - d00)) + ay * (d01 + ax * (d11 - d01)), true};
}

// Whether the rays through the four pixels around an image position meet nothing. Beside an outline half a pixel may be wrong, so all of them must.
bool IsFree(const ViewCamera& view, float u, float v) {
  const int x = static_cast<int>(u + 0.5F) - 1;
  const int y = static_cast<int>(v + 0.5F) - 1;
  if (x < 0 || y < 0 || x + 1 >= view.width || y + 1 >= view.height) return false;
  const size_t upper = static_cast<size_t>(y) * static_cast<size_t>(view.width) + static_cast<size_t>(x);
  const size_t lower = upper + static_cast<size_t>(view.width);
  const auto is_free = [&view](size_t pixel) { return view.cosine[pixel] == kMeetsNothing && !IsDepth(view.depth_m[pixel]); };
  return is_free(upper) && is_free(upper + 1) && is_free(lower) && is_free(lower + 1);
}

// Adds what the view knows about a node at image position (u, v) and the square of its distance to the camera.
void AddToNode(const ViewCamera& view, float u, float v, float distance2, const Weighting& weighting, const BrickSums& sums, size_t node) {
  const size_t pixel = static_cast<size_t>(static_cast<int>(v)) * static_cast<size_t>(view.width) + static_cast<size_t>(static_cast<int>(u));
  const float nearest = view.depth_m[pixel];
  if (!IsDepth(nearest)) {
    // As before a surface that the ray meets at right angles.
    if (!IsFree(view, u, v)) return;
    const float weight = weighting.area / distance2;
    sums.psi[node] += weight;
    sums.weight[node] += weight;
    return;
  }
  const float truncation = weighting.truncation_m;
  const float distance = std::sqrt(distance2);
  const float cosine = std::max(static_cast<float>(view.cosine[pixel]) * kCosineUnit, weighting.lowest_cosine);
  // Much further behind a surface than the truncation: interpolation changes nothing.
  if ((nearest - distance) * cosine < -2.0F * truncation) return;
  const Lookup lookup = DepthAt(view, u, v, nearest, distance + truncation / cosine, weighting);
  // Distance to the tangent plane at the pixel, positive in front of the surface.
  const float signed_distance = (lookup.depth_m - distance) * cosine;
  // Behind the surface it is less and less certain what follows: without a falling weight, rays that graze a roof or a ball would thicken its other
  // side (Bylow et al. 2013; Oleynikova et al. 2017).
  const float certainty = std::min((signed_distance + truncation) * weighting.behind, 1.0F) * (lookup.sure ? 1.0F : kUnsureWeight);
  const uint8_t counts = view.weight != nullptr ? view.weight[pixel] : kFullWeight;
  const float share = static_cast<float>(std::min(counts, kFullWeight)) * (1.0F / kFullWeight);
  const float weight = cosine * weighting.area / distance2 * certainty * share;
  if (!(weight > 0.0F)) return;
  sums.psi[node] += weight * std::min(signed_distance / truncation, 1.0F);
  sums.weight[node] += weight;
  if (std::abs(signed_distance) <= 0.5F * truncation) {
    const int seen = counts == kConfirmedWeight ? 2 : 1;
    CountUp(&sums.views[node], seen);
    if (view.photo) CountUp(&sums.photos[node], seen);
  }
}

void AddView(const ViewCamera& view, const Eigen::Vector3i& brick, double voxel_m, const Weighting& weighting, const BrickSums& sums) {
  const Eigen::Matrix3d step = view.rotation * voxel_m;
  const Eigen::Vector3d first = view.rotation * (kBrickSide * brick.cast<double>() * voxel_m - view.centre);
  const Eigen::Vector3f step_x = step.col(0).cast<float>();
  const auto focal = static_cast<float>(view.focal_px);
  const auto cx = static_cast<float>(view.cx), cy = static_cast<float>(view.cy);
  const auto width = static_cast<float>(view.width), height = static_cast<float>(view.height);
  for (int y_and_z = 0; y_and_z < kBrickSide * kBrickSide; ++y_and_z) {
    const Eigen::Vector3f row = (first + step.col(1) * (y_and_z % kBrickSide) + step.col(2) * (y_and_z / kBrickSide)).cast<float>();
    float u[kBrickSide], v[kBrickSide], z[kBrickSide], distance2[kBrickSide];
    for (int i = 0; i < kBrickSide; ++i) {
      const auto steps = static_cast<float>(i);
      const float x_in_camera = row[0] + steps * step_x[0];
      const float y_in_camera = row[1] + steps * step_x[1];
      z[i] = row[2] + steps * step_x[2];
      const float scale = focal / z[i];
      u[i] = x_in_camera * scale + cx;
      v[i] = y_in_camera * scale + cy;
      distance2[i] = x_in_camera * x_in_camera + y_in_camera * y_in_camera + z[i] * z[i];
    }
    for (int i = 0; i < kBrickSide; ++i) {
      if (!(z[i] > 0.0F && u[i] >= 0.0F && u[i] < width && v[i] >= 0.0F && v[i] < height)) continue;
      AddToNode(view, u[i], v[i], distance2[i], weighting, sums, static_cast<size_t>(y_and_z * kBrickSide + i));
    }
  }
}

}  // namespace

NodeField IntegrateViews(std::span<const ViewCamera> views, const Bricks& bricks, const FuseOptions& options, base::ThreadPool& threads) {
  const double voxel = options.voxel_m;
  // A surface seen at a flatter angle than 85 degrees would carry no weight at all.
  const double angle = std::min(options.max_angle_deg, 85.0) * std::numbers::pi / 180.0;
  const Weighting weighting{static_cast<float>(options.truncation_voxels * voxel), static_cast<float>(std::cos(angle)),
                            static_cast<float>(1.0 / (std::max(0.5 * options.truncation_voxels, options.truncation_voxels - 1.0) * voxel)),
                            static_cast<float>(1e6 * voxel * voxel)};
  const size_t n_nodes = bricks.size() * static_cast<size_t>(kBrickNodes);
  NodeField field{std::vector<float>(n_nodes), std::vector<uint8_t>(n_nodes), std::vector<uint8_t>(n_nodes)};
  const Eigen::Vector3d to_middle = Eigen::Vector3d::Constant(0.5 * (kBrickSide - 1) * voxel);
  // A little more than to the farthest node.
  const double radius_m = 1.01 * to_middle.norm();
  const auto n_tasks = static_cast<int64_t>((bricks.size() + kBricksPerTask - 1) / kBricksPerTask);
  threads.ParallelFor(n_tasks, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const size_t begin = static_cast<size_t>(task) * kBricksPerTask;
    const size_t end = std::min(begin + kBricksPerTask, bricks.size());
    for (size_t i = begin; i < end; ++i) {
      const Eigen::Vector3i brick = BrickOfKey(bricks.key[i]);
      const Eigen::Vector3d middle = kBrickSide * brick.cast<double>() * voxel + to_middle;
      const size_t first = i * static_cast<size_t>(kBrickNodes);
      float weight[kBrickNodes] = {};
      const BrickSums sums{&field.psi[first], weight, &field.views[first], &field.photos[first]};
      for (const ViewCamera& view : views) {
        if (MaySeeSphere(view, middle, radius_m)) AddView(view, brick, voxel, weighting, sums);
      }
      for (size_t node = 0; node < kBrickNodes; ++node) {
        sums.psi[node] = weight[node] > 0.0F ? sums.psi[node] / weight[node] : std::numeric_limits<float>::quiet_NaN();
      }
    }
  });
  return field;
}

}  // namespace skyquilt::surface
