#include "evaluate/surface/f_score.h"

#include <fmt/core.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "core/base/cancel.h"
#include "core/base/order_statistics.h"
#include "core/base/progress.h"
#include "evaluate/measured.h"
#include "evaluate/photos/pixel_groups.h"
#include "evaluate/surface/nearest.h"
#include "evaluate/surface/photo_errors.h"

namespace skyquilt::evaluate::surface {
namespace {

constexpr int64_t kMostSamples = 2'000'000;
constexpr int64_t kSamplesPerTask = 2048;
constexpr double kSpacingWithoutGsd_m = 0.05;
constexpr float kFarAway = std::numeric_limits<float>::infinity();
constexpr uint8_t kIgnored = 255;  // instead of a class

// Distance of a sample to the other surface, and the class of its true surface.
struct SampleDistance {
  float distance_m = kFarAway;
  uint8_t class_id = kIgnored;
};

bool IsScored(uint8_t class_id) {
  using survey::SurfaceClass;
  const auto is = [&](SurfaceClass one) { return class_id == static_cast<uint8_t>(one); };
  return class_id < survey::kSurfaceClasses && !is(SurfaceClass::kNone) && !is(SurfaceClass::kMovingCar) && !is(SurfaceClass::kPerson) &&
         !is(SurfaceClass::kWater);
}

double AreaPerSample(double gsd_m) {
  const double spacing_m = gsd_m > 0.0 ? gsd_m : kSpacingWithoutGsd_m;
  return 0.5 * spacing_m * spacing_m;
}

// Whether a triangle reaches into the rectangle around the boxes, seen from above.
class NearBoxes {
 public:
  NearBoxes(std::span<const geo::BlockBox> boxes, const Eigen::Vector3d& middle) {
    for (const geo::BlockBox& box : boxes) {
      low_ = low_.cwiseMin((box.min_enu - middle).head<2>());
      high_ = high_.cwiseMax((box.max_enu - middle).head<2>());
    }
  }
  bool Touches(const std::vector<Eigen::Vector3f>& position, const std::array<uint32_t, 3>& corner) const {
    Eigen::Vector2d low = position[corner[0]].head<2>().cast<double>(), high = low;
    for (const uint32_t c : corner) {
      low = low.cwiseMin(position[c].head<2>().cast<double>());
      high = high.cwiseMax(position[c].head<2>().cast<double>());
    }
    return (low.array() <= high_.array()).all() && (high.array() >= low_.array()).all();
  }

 private:
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high_ = -low_;
};

std::vector<SampleDistance> ForAllSamples(std::span<const SurfaceSample> samples, base::Progress& progress, base::ThreadPool& threads,
                                          const std::function<SampleDistance(const SurfaceSample&)>& measure) {
  std::vector<SampleDistance> distances(samples.size());
  const auto n = static_cast<int64_t>(samples.size());
  threads.ParallelFor((n + kSamplesPerTask - 1) / kSamplesPerTask, [&](int64_t task, int) {
    base::ThrowIfCancelled();
    const int64_t first = task * kSamplesPerTask, last = std::min(n, first + kSamplesPerTask);
    for (int64_t i = first; i < last; ++i) distances[static_cast<size_t>(i)] = measure(samples[static_cast<size_t>(i)]);
    progress.Advance(static_cast<double>(last - first));
  });
  return distances;
}

// Distances of the classes for which `belongs` holds.
std::vector<float> DistancesOf(std::span<const SampleDistance> all, const std::function<bool(uint8_t)>& belongs) {
  std::vector<float> distances;
  for (const SampleDistance& one : all) {
    if (one.class_id != kIgnored && belongs(one.class_id)) distances.push_back(one.distance_m);
  }
  return distances;
}

double ShareWithin(const std::vector<float>& distances, double tau_m) {
  if (distances.empty()) return kNotMeasured;
  const auto n = std::count_if(distances.begin(), distances.end(), [&](float distance) { return static_cast<double>(distance) < tau_m; });
  return static_cast<double>(n) / static_cast<double>(distances.size());
}

SurfaceAgreement AgreementOf(std::vector<float> from_mesh, std::vector<float> from_truth, std::span<const ScoredDistance> taus) {
  SurfaceAgreement agreement;
  agreement.mesh_samples = static_cast<int64_t>(from_mesh.size());
  agreement.true_samples = static_cast<int64_t>(from_truth.size());
  for (const ScoredDistance& tau : taus) {
    SurfaceFScore score{.tau = tau.name, .tau_m = tau.tau_m};
    score.precision = ShareWithin(from_mesh, tau.tau_m);
    score.recall = ShareWithin(from_truth, tau.tau_m);
    const double sum = score.precision + score.recall;
    score.f = sum > 0.0 ? 2.0 * score.precision * score.recall / sum : sum;  // 0 for 0, NaN for NaN
    agreement.f_scores.push_back(std::move(score));
  }
  if (!from_mesh.empty()) agreement.accuracy_median_m = static_cast<double>(base::UpperMedian(from_mesh));
  if (!from_truth.empty()) agreement.completeness_median_m = static_cast<double>(base::UpperMedian(from_truth));
  return agreement;
}

}  // namespace

std::vector<ScoredDistance> ScoredDistances(double gsd_m) {
  std::vector<ScoredDistance> distances;
  if (gsd_m > 0.0) {
    for (const int n : {1, 2, 5}) distances.push_back({fmt::format("{} GSD", n), n * gsd_m});
  }
  for (const int n : {5, 10, 20}) distances.push_back({fmt::format("{} cm", n), 0.01 * n});
  return distances;
}

std::vector<SurfaceSample> SampleMesh(const SurfacePair& pair) {
  const NearBoxes near(pair.boxes, pair.mesh.middle);
  std::vector<SurfaceSample> samples = SampleSurface(
      pair.mesh.position, pair.mesh.triangle,
      [&](uint32_t i) { return !pair.mesh.IsFilled(i) && near.Touches(pair.mesh.position, pair.mesh.triangle[i]); }, AreaPerSample(pair.gsd_m),
      kMostSamples);
  std::erase_if(samples,
                [&](const SurfaceSample& sample) { return photos::BlockAt(pair.mesh.middle + sample.point.cast<double>(), pair.boxes) < 0; });
  return samples;
}

SurfaceComparison CompareSurfaces(const SurfacePair& pair, std::span<const SurfaceSample> mesh_samples, base::ThreadPool& threads) {
  const SurfaceMesh& mesh = pair.mesh;
  const TrueSurface& truth = pair.truth;
  const std::vector<ScoredDistance> taus = ScoredDistances(pair.gsd_m);
  double limit_m = 0.0;
  for (const ScoredDistance& tau : taus) limit_m = std::max(limit_m, 2.0 * tau.tau_m);
  const NearBoxes near(pair.boxes, truth.middle);
  const std::vector<SurfaceSample> true_samples = SampleSurface(
      truth.position, truth.triangle, [&](uint32_t i) { return IsScored(truth.class_id[i]) && near.Touches(truth.position, truth.triangle[i]); },
      AreaPerSample(pair.gsd_m), kMostSamples);

  base::Progress progress("surface scores", static_cast<double>(mesh_samples.size() + true_samples.size()), "points");
  std::vector<SampleDistance> from_mesh, from_truth;
  {
    const NearestTriangles nearest(truth.position, truth.triangle);
    from_mesh = ForAllSamples(mesh_samples, progress, threads, [&](const SurfaceSample& sample) -> SampleDistance {
      const Eigen::Vector3d point = mesh.middle - truth.middle + sample.point.cast<double>();
      const auto found = nearest.Nearest(point, limit_m);
      if (!found) return {kFarAway, static_cast<uint8_t>(survey::SurfaceClass::kNone)};
      const uint8_t class_id = truth.class_id[found->triangle];
      if (!IsScored(class_id) || !pair.seen.Sees(truth.middle + found->point, truth.Normal(found->triangle))) return {};
      return {static_cast<float>(found->distance_m), class_id};
    });
  }
  {
    std::vector<std::array<uint32_t, 3>> measured;
    for (uint32_t i = 0; i < mesh.triangle.size(); ++i) {
      if (!mesh.IsFilled(i)) measured.push_back(mesh.triangle[i]);
    }
    const NearestTriangles nearest(mesh.position, measured);
    from_truth = ForAllSamples(true_samples, progress, threads, [&](const SurfaceSample& sample) -> SampleDistance {
      const Eigen::Vector3d point = truth.middle + sample.point.cast<double>();
      if (!pair.seen.Sees(point, truth.Normal(sample.triangle))) return {};
      const auto found = nearest.Nearest(point - mesh.middle, limit_m);
      return {found ? static_cast<float>(found->distance_m) : kFarAway, truth.class_id[sample.triangle]};
    });
  }
  progress.Finish();

  const auto any = [](uint8_t) { return true; };
  SurfaceComparison comparison;
  comparison.all = AgreementOf(DistancesOf(from_mesh, any), DistancesOf(from_truth, any), taus);
  for (const ScoredClass& group : ScoredClasses()) {
    const auto belongs = [&](uint8_t id) {
      return std::find(group.members.begin(), group.members.end(), static_cast<survey::SurfaceClass>(id)) != group.members.end();
    };
    comparison.by_class.push_back(AgreementOf(DistancesOf(from_mesh, belongs), DistancesOf(from_truth, belongs), taus));
  }
  return comparison;
}

}  // namespace skyquilt::evaluate::surface
