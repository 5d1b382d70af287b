#include "prepare/bundle/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/cancel.h"
#include "core/linear/linear.h"

namespace skyquilt::prepare::bundle {
namespace {

struct Sight {
  uint32_t entry;
  Eigen::Vector3d centre, direction;  // ENU, length 1
};

Sight SightOf(const BundleProblem& bundle, const std::vector<camera::Camera>& cameras, uint32_t entry) {
  const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[entry].photo];
  const Eigen::Vector3d ray = cameras[static_cast<size_t>(photo.lens)].RayFromImg(bundle.pixel[entry]);
  return {entry, photo.centre, photo.cam_from_enu.conjugate() * ray};
}

std::vector<camera::Camera> CamerasOf(const BundleProblem& bundle) {
  std::vector<camera::Camera> cameras;
  for (const BundleLens& lens : bundle.lenses) cameras.push_back(CameraOf(lens.numbers, lens.camera));
  return cameras;
}

std::vector<Sight> SightsOf(const BundleProblem& bundle, const std::vector<camera::Camera>& cameras, uint32_t track) {
  std::vector<Sight> sights;
  for (uint32_t e = bundle.tracks.first[track]; e < bundle.tracks.first[track + 1]; ++e) {
    if (bundle.photos[bundle.tracks.entries[e].photo].placed) sights.push_back(SightOf(bundle, cameras, e));
  }
  return sights;
}

// Middle of the shortest line between two rays; false when they are almost parallel.
bool Meet(const Sight& a, const Sight& b, Eigen::Vector3d* x) {
  const double c = a.direction.dot(b.direction);
  const double sine_square = 1.0 - c * c;
  constexpr double kLeast = 1e-5;  // 0.2 degrees
  if (sine_square < kLeast) return false;
  const Eigen::Vector3d between = b.centre - a.centre;
  const double along_a = between.dot(a.direction), along_b = between.dot(b.direction);
  const double s = (along_a - c * along_b) / sine_square, t = (c * along_a - along_b) / sine_square;
  *x = 0.5 * (a.centre + s * a.direction + b.centre + t * b.direction);
  return true;
}

struct Support {
  size_t n = 0;
  double error = 0.0;  // sum over those that agree
  bool Better(const Support& other) const { return n != other.n ? n > other.n : error < other.error; }
};

Support SupportOf(const BundleProblem& bundle, const std::vector<Sight>& sights, const Eigen::Vector3d& x, double threshold) {
  Support support;
  for (const Sight& sight : sights) {
    const double error = bundle.Error(sight.entry, x);
    if (error < 0.0 || error > threshold) continue;
    ++support.n;
    support.error += error;
  }
  return support;
}

// Three steps towards the least squares of the entries within the threshold.
Eigen::Vector3d Refined(const BundleProblem& bundle, const std::vector<Sight>& sights, Eigen::Vector3d x, double threshold) {
  for (int step = 0; step < 3; ++step) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const Sight& sight : sights) {
      const double error = bundle.Error(sight.entry, x);
      if (error < 0.0 || error > threshold) continue;
      const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[sight.entry].photo];
      const BundleLens& lens = bundle.lenses[static_cast<size_t>(photo.lens)];
      LensJacobian jacobian;
      const Eigen::Vector2d residual =
          (Project(lens.numbers, photo.cam_from_enu * (x - photo.centre), &jacobian) - bundle.pixel[sight.entry]) / lens.unit_px;
      const Eigen::Matrix<double, 2, 3> by_x = jacobian.by_point * photo.cam_from_enu.toRotationMatrix() / lens.unit_px;
      normal += by_x.transpose() * by_x;
      gradient += by_x.transpose() * residual;
    }
    normal.diagonal() *= 1.0 + 1e-9;
    const Eigen::Vector3d change = linear::SolveSymmetric(normal, gradient);
    if (!change.allFinite()) break;
    x -= change;
  }
  return x;
}

bool WideEnough(const BundleProblem& bundle, const std::vector<Sight>& sights, const Eigen::Vector3d& x) {
  const double most = std::cos(kLeastAngle_deg * std::numbers::pi / 180.0);
  std::vector<Eigen::Vector3d> directions;
  for (const Sight& sight : sights) {
    if (bundle.agrees[sight.entry] == 0) continue;
    const Eigen::Vector3d direction = (x - sight.centre).normalized();
    for (const Eigen::Vector3d& other : directions) {
      if (direction.dot(other) < most) return true;
    }
    directions.push_back(direction);
  }
  return false;
}

void TriangulateWith(BundleProblem& bundle, const std::vector<camera::Camera>& cameras, uint32_t track, double threshold) {
  const uint32_t first = bundle.tracks.first[track], last = bundle.tracks.first[track + 1];
  std::fill(bundle.agrees.begin() + first, bundle.agrees.begin() + last, char{0});
  const std::vector<Sight> sights = SightsOf(bundle, cameras, track);
  Eigen::Vector3d best = bundle.point[track];
  Support support;
  if (bundle.has_point[track] != 0) support = SupportOf(bundle, sights, best, threshold);
  bundle.has_point[track] = 0;
  if (sights.size() < 2) return;
  if (support.n < sights.size()) {
    // Far and near pairs of entries alike, but not all of a long track.
    constexpr size_t kMaxTries = 24;
    const size_t n = sights.size(), n_pairs = n * (n - 1) / 2, step = std::max<size_t>(1, n_pairs / kMaxTries);
    size_t count = 0;
    for (size_t gap = n - 1; gap >= 1; --gap) {
      for (size_t i = 0; i + gap < n; ++i) {
        Eigen::Vector3d x;
        if (count++ % step != 0 || !Meet(sights[i], sights[i + gap], &x)) continue;
        const Support other = SupportOf(bundle, sights, x, threshold);
        if (other.n < 2 || !other.Better(support)) continue;
        support = other;
        best = x;
      }
    }
  }
  if (support.n < 2) return;
  const Eigen::Vector3d refined = Refined(bundle, sights, best, threshold);
  if (refined.allFinite() && !support.Better(SupportOf(bundle, sights, refined, threshold))) best = refined;
  for (const Sight& sight : sights) {
    const double error = bundle.Error(sight.entry, best);
    bundle.agrees[sight.entry] = error >= 0.0 && error <= threshold ? 1 : 0;
  }
  bundle.point[track] = best;
  bundle.has_point[track] = WideEnough(bundle, sights, best) ? 1 : 0;
  if (bundle.has_point[track] == 0) std::fill(bundle.agrees.begin() + first, bundle.agrees.begin() + last, char{0});
}

constexpr size_t kTracksPerTask = 256;

}  // namespace

void TriangulateTrack(BundleProblem& bundle, uint32_t track, double threshold) {
  TriangulateWith(bundle, CamerasOf(bundle), track, threshold);
}

void Triangulate(BundleProblem& bundle, std::span<const uint32_t> tracks, double threshold, base::ThreadPool& threads) {
  const std::vector<camera::Camera> cameras = CamerasOf(bundle);
  const size_t n_tasks = (tracks.size() + kTracksPerTask - 1) / kTracksPerTask;
  threads.ParallelFor(static_cast<int64_t>(n_tasks), [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const size_t begin = static_cast<size_t>(task) * kTracksPerTask, end = std::min(begin + kTracksPerTask, tracks.size());
    for (size_t i = begin; i < end; ++i) TriangulateWith(bundle, cameras, tracks[i], threshold);
  });
}

void TriangulateAll(BundleProblem& bundle, double threshold, base::ThreadPool& threads) {
  std::vector<uint32_t> all(bundle.tracks.size());
  for (uint32_t t = 0; t < all.size(); ++t) all[t] = t;
  Triangulate(bundle, all, threshold, threads);
}

void PlaceOnGround(BundleProblem& bundle, std::span<const uint32_t> tracks, double height_m) {
  const std::vector<camera::Camera> cameras = CamerasOf(bundle);
  for (const uint32_t t : tracks) {
    const std::vector<Sight> sights = SightsOf(bundle, cameras, t);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (const Sight& sight : sights) {
      // Flat rays reach the ground far away, at a place that is hardly known.
      constexpr double kFlattest = 0.2;
      const double descent = std::max(-sight.direction.z(), kFlattest);
      const double weight = descent * descent;
      sum += weight * (sight.centre + height_m / descent * sight.direction);
      total += weight;
    }
    bundle.has_point[t] = sights.size() >= 2 ? 1 : 0;
    if (bundle.has_point[t] == 0) continue;
    bundle.point[t] = sum / total;
    for (const Sight& sight : sights) bundle.agrees[sight.entry] = 1;
  }
}

}  // namespace skyquilt::prepare::bundle
