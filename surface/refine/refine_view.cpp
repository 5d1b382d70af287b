#include "surface/refine/refine_view.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"

namespace skyquilt::surface {
namespace {

using kernel::kMatchPixels;
using kernel::kNoMatch;

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kNotScored = -1e9F;
constexpr size_t kMostSources = 8;
constexpr int kSlopeReach = 3;               // pixels to both sides from which a rendered depth's slope is taken
constexpr float kJump_px = 2.0F;             // disparity between pixels of two surfaces
constexpr int kNeighbours = 4, kTrials = 2;  // planes of other pixels, and random ones, that each pixel tries in a sweep
constexpr float kFirstReach_px = 2.0F;       // of random changes in the first sweep; later sweeps halve it
constexpr float kNotable = 0.01F;            // where no score near by has grown by this in a sweep, the next one would find nothing
constexpr float kPoor = 0.5F;                // unless the correlation is below this

// One plane per pixel, see kernel::MatchPlanes, and how well photos agree under it.
struct Planes {
  std::vector<float> a, slope_x, slope_y, score, correlation;
  std::vector<float> grown;  // of the score, by the sweep before
  explicit Planes(size_t n) : a(n, kUnknown), slope_x(n, 0.0F), slope_y(n, 0.0F), score(n, kNotScored), correlation(n, kNoMatch), grown(n, 1.0F) {}
};

struct Plane {
  float a = kUnknown, slope_x = 0.0F, slope_y = 0.0F;
};

Eigen::Matrix3d Intrinsics(const ViewPose& pose) {
  // Pixel (x, y) of a match picture has its middle at (x, y).
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = k(1, 1) = pose.focal_px;
  k(0, 2) = pose.cx - 0.5;
  k(1, 2) = pose.cy - 0.5;
  return k;
}

kernel::MatchTransform TransformOf(const ViewPose& own, const ViewPose& other) {
  const Eigen::Matrix3d rotation = (other.cam_from_enu.rotation * own.cam_from_enu.rotation.conjugate()).toRotationMatrix();
  Eigen::Matrix3d ray_from_pixel = Eigen::Matrix3d::Identity() / own.focal_px;
  ray_from_pixel.col(2) << (0.5 - own.cx) / own.focal_px, (0.5 - own.cy) / own.focal_px, 1.0;
  const Eigen::Matrix3d h = Intrinsics(other) * rotation * ray_from_pixel;
  const Eigen::Vector3d t = Intrinsics(other) * (other.cam_from_enu.translation - rotation * own.cam_from_enu.translation);
  kernel::MatchTransform result{};
  for (Eigen::Index r = 0; r < 3; ++r) {
    for (Eigen::Index c = 0; c < 3; ++c) result.h[static_cast<size_t>(3 * r + c)] = static_cast<float>(h(r, c));
    result.t[static_cast<size_t>(r)] = static_cast<float>(t[r]);
  }
  return result;
}

// Uniform in [-1, 1] from pixel and turn: the same for any number of threads.
float Noise(size_t pixel, uint32_t turn) {
  uint64_t h = (static_cast<uint64_t>(pixel) << 8U | turn) * 0x9E3779B97F4A7C15ULL;
  h ^= h >> 29U;
  h *= 0xBF58476D1CE4E5B9ULL;
  h ^= h >> 32U;
  return static_cast<float>(static_cast<double>(h & 0xffffffU) / 8388607.5 - 1.0);
}

// Mean of the better half of the correlations, at least of two: what hides a place hides it in some photos only. kNoMatch with fewer.
float BetterHalf(std::array<float, kMostSources>& correlations, size_t n) {
  if (n < 2) return kNoMatch;
  const size_t half = std::max<size_t>(2, (n + 1) / 2);
  std::partial_sort(correlations.begin(), correlations.begin() + static_cast<std::ptrdiff_t>(half),
                    correlations.begin() + static_cast<std::ptrdiff_t>(n), std::greater<>());
  return std::accumulate(correlations.begin(), correlations.begin() + static_cast<std::ptrdiff_t>(half), 0.0F) / static_cast<float>(half);
}

// All pixels try the planes of their neighbours and random changes of their own, sweep by sweep. A sweep reads the planes of the one before, so that
// the order of pixels does not matter.
class PlaneSearch {
 public:
  PlaneSearch(const ViewPose& pose, std::span<const float> depth_m, const kernel::MatchPicture& own, std::span<const RefineSource> sources,
              const RefineOptions& options, base::ThreadPool& threads)
      : pose_(pose),
        own_(own),
        sources_(sources.first(std::min(sources.size(), kMostSources))),
        options_(options),
        threads_(threads),
        rendered_(depth_m.size(), kUnknown),
        now_(depth_m.size()),
        next_(depth_m.size()) {
    std::vector<double> disparities;
    for (const RefineSource& source : sources_) {
      transforms_.push_back(TransformOf(pose, source.pose));
      disparities.push_back((source.pose.Centre() - pose.Centre()).norm() * source.pose.focal_px);
    }
    if (!disparities.empty()) px_per_a_ = static_cast<float>(base::UpperMedian(disparities));
    for (int y = 0; y < pose.height; ++y) {
      for (int x = 0; x < pose.width; ++x) {
        if (const float depth = depth_m[Index(x, y)]; depth > 0.0F) {
          rendered_[Index(x, y)] = static_cast<float>(LengthAt(pose, x, y) / static_cast<double>(depth));
        }
      }
    }
    now_.a = rendered_;
  }

  RefinedDepth Run() {
    if (sources_.size() >= 2) {
      threads_.ParallelFor(pose_.height, [&](int64_t row, int) { SetSlopes(static_cast<int>(row)); });
      for (int sweep = 0; sweep <= options_.iterations; ++sweep) {
        base::ThrowIfCancelled();
        threads_.ParallelFor(pose_.height, [&](int64_t row, int) { Sweep(sweep, static_cast<int>(row)); });
        std::swap(now_, next_);
      }
    }
    return {std::move(now_.a), std::move(now_.slope_x), std::move(now_.slope_y), std::move(now_.correlation)};
  }

 private:
  size_t Index(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(pose_.width) + static_cast<size_t>(x); }
  bool Inside(int x, int y) const { return x >= 0 && y >= 0 && x < pose_.width && y < pose_.height; }

  void SetSlopes(int y) {
    for (int x = 0; x < pose_.width; ++x) {
      now_.slope_x[Index(x, y)] = RenderedSlope(x, y, 1, 0);
      now_.slope_y[Index(x, y)] = RenderedSlope(x, y, 0, 1);
    }
  }

  // The median of the steps around the pixel, without jumps.
  float RenderedSlope(int x, int y, int dx, int dy) const {
    std::array<float, 2 * kSlopeReach> steps{};
    size_t n = 0;
    for (int k = -kSlopeReach; k < kSlopeReach; ++k) {
      const int x0 = x + k * dx, y0 = y + k * dy;
      if (!Inside(x0, y0) || !Inside(x0 + dx, y0 + dy)) continue;
      const float step = rendered_[Index(x0 + dx, y0 + dy)] - rendered_[Index(x0, y0)];
      if (std::abs(step) * px_per_a_ < kJump_px) steps[n++] = step;
    }
    if (n == 0) return 0.0F;
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(steps.begin(), middle, steps.begin() + static_cast<std::ptrdiff_t>(n));
    return *middle;
  }

  // The first sweep scores the rendered planes.
  void Sweep(int sweep, int y) {
    kernel::MatchWindows windows{};
    std::vector<int> places;
    for (int first = 0; first < pose_.width; first += kMatchPixels) {
      const int count = std::min(kMatchPixels, pose_.width - first);
      places.clear();
      for (int i = 0; i < count; ++i) {
        Copy(Index(first + i, y));
        if (sweep == 0 ? now_.a[Index(first + i, y)] > 0.0F : MayGrow(first + i, y, StepOf(sweep))) places.push_back(i);
      }
      if (places.empty()) continue;
      kernel::FillMatchWindows(own_, first, y, count, &windows);
      windows.Keep(places);
      const int planes = sweep == 0 ? 1 : kNeighbours + kTrials;
      for (int k = 0; k < planes; ++k) {
        Try(windows, places, first, [&](int x) { return sweep == 0 ? PlaneOf(now_, Index(x, y)) : Candidate(sweep, k, x, y); });
      }
      for (const int i : places) {
        const size_t at = Index(first + i, y);
        next_.grown[at] = sweep == 0 ? 1.0F : next_.score[at] - now_.score[at];
      }
    }
  }

  static int StepOf(int sweep) {
    constexpr std::array<int, 4> kSteps = {1, 3, 2, 1};
    return kSteps[static_cast<size_t>(sweep - 1) % kSteps.size()];
  }

  void Copy(size_t i) {
    next_.a[i] = now_.a[i];
    next_.slope_x[i] = now_.slope_x[i];
    next_.slope_y[i] = now_.slope_y[i];
    next_.score[i] = now_.score[i];
    next_.correlation[i] = now_.correlation[i];
    next_.grown[i] = 0.0F;
  }

  static Plane PlaneOf(const Planes& planes, size_t i) { return {planes.a[i], planes.slope_x[i], planes.slope_y[i]}; }

  bool MayGrow(int x, int y, int step) const {
    if (now_.correlation[Index(x, y)] < kPoor) return true;
    const auto grew = [&](int dx, int dy) { return Inside(x + dx, y + dy) && now_.grown[Index(x + dx, y + dy)] > kNotable; };
    return grew(0, 0) || grew(step, 0) || grew(-step, 0) || grew(0, step) || grew(0, -step);
  }

  // The neighbours' planes first, then changes of the best so far: of its depth, and of its slopes too.
  Plane Candidate(int sweep, int k, int x, int y) const {
    if (k < kNeighbours) {
      constexpr std::array<std::array<int, 2>, kNeighbours> kWays = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
      const int dx = StepOf(sweep) * kWays[static_cast<size_t>(k)][0], dy = StepOf(sweep) * kWays[static_cast<size_t>(k)][1];
      if (!Inside(x + dx, y + dy)) return {};
      Plane plane = PlaneOf(now_, Index(x + dx, y + dy));
      plane.a -= plane.slope_x * static_cast<float>(dx) + plane.slope_y * static_cast<float>(dy);
      return plane;
    }
    const size_t i = Index(x, y);
    const auto turn = static_cast<uint32_t>(3 * (kTrials * sweep + k - kNeighbours));
    const float reach = std::ldexp(kFirstReach_px / px_per_a_, 1 - sweep);
    Plane plane = PlaneOf(next_, i);
    plane.a += reach * Noise(i, turn);
    if (k > kNeighbours) {
      plane.slope_x += 0.5F * reach * Noise(i, turn + 1);
      plane.slope_y += 0.5F * reach * Noise(i, turn + 2);
    }
    return plane;
  }

  template <typename Make>
  void Try(const kernel::MatchWindows& windows, std::span<const int> places, int first, const Make& make) {
    std::array<float, kMatchPixels> a{}, slope_x{}, slope_y{};
    std::array<std::array<float, kMatchPixels>, kMostSources> found;
    for (size_t n = 0; n < places.size(); ++n) {
      const int x = first + places[n];
      const Plane plane = make(x);
      const float rendered = rendered_[Index(x, windows.y)];
      const bool too_far = std::abs(plane.a - rendered) * px_per_a_ > static_cast<float>(options_.range_px);
      a[n] = plane.a > 0.0F && !too_far ? plane.a : kUnknown;
      slope_x[n] = plane.slope_x;
      slope_y[n] = plane.slope_y;
    }
    for (size_t s = 0; s < sources_.size(); ++s) {
      kernel::MatchUnderPlanes(windows, *sources_[s].picture, transforms_[s], {a.data(), slope_x.data(), slope_y.data()}, found[s].data());
    }
    for (size_t n = 0; n < places.size(); ++n) {
      if (!(a[n] > 0.0F)) continue;
      std::array<float, kMostSources> correlations{};
      size_t known = 0;
      for (size_t s = 0; s < sources_.size(); ++s) {
        if (found[s][n] > kNoMatch) correlations[known++] = found[s][n];
      }
      const float correlation = BetterHalf(correlations, known);
      if (correlation == kNoMatch) continue;
      const size_t i = Index(first + places[n], windows.y);
      const float away_px = std::isnan(rendered_[i]) ? 0.0F : (a[n] - rendered_[i]) * px_per_a_;
      const float score = correlation - static_cast<float>(options_.prior) * away_px * away_px;
      if (!(score > next_.score[i])) continue;
      next_.a[i] = a[n];
      next_.slope_x[i] = slope_x[n];
      next_.slope_y[i] = slope_y[n];
      next_.score[i] = score;
      next_.correlation[i] = correlation;
    }
  }

  const ViewPose& pose_;
  const kernel::MatchPicture& own_;
  std::span<const RefineSource> sources_;
  const RefineOptions& options_;
  base::ThreadPool& threads_;
  std::vector<float> rendered_;  // inverse depths along the optical axis
  std::vector<kernel::MatchTransform> transforms_;
  float px_per_a_ = 1.0F;  // disparity in a typical source per inverse depth
  Planes now_, next_;
};

}  // namespace

// Points of the plane have inverse depths a + sx dx + sy dy at (dx, dy) pixels from the pixel, which is the dot product of their rays (u, v, 1) with
// (f sx, f sy, a - f (sx u0 + sy v0)): its normal.
double RefinedDepth::CosineAt(const ViewPose& pose, int x, int y) const {
  const size_t at = static_cast<size_t>(y) * static_cast<size_t>(pose.width) + static_cast<size_t>(x);
  const double a = static_cast<double>(inverse_depth[at]);
  const double sx = static_cast<double>(slope_x[at]), sy = static_cast<double>(slope_y[at]);
  const Eigen::Vector3d normal(pose.focal_px * sx, pose.focal_px * sy, a - sx * (x + 0.5 - pose.cx) - sy * (y + 0.5 - pose.cy));
  return a / (normal.norm() * LengthAt(pose, x, y));
}

RefinedDepth RefineDepth(const ViewPose& pose, std::span<const float> depth_m, const kernel::MatchPicture& own, std::span<const RefineSource> sources,
                         const RefineOptions& options, base::ThreadPool& threads) {
  return PlaneSearch(pose, depth_m, own, sources, options, threads).Run();
}

}  // namespace skyquilt::surface
