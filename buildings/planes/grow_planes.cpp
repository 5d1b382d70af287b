#include "buildings/planes/grow_planes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "buildings/planes/neighbourhoods.h"
#include "buildings/planes/plane_sums.h"
#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt::buildings {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
constexpr float kRoughestSeed = 0.04F;
constexpr double kRefitGrowth = 1.2;     // a plane is fitted again whenever it has so many times more points
constexpr int kSettleRounds = 3;         // of moving points between planes
constexpr double kLooserAngle_deg = 20;  // normals beside an edge are mixtures of both planes'
constexpr double kMergeAngle_deg = 8.0;
constexpr int kLeastMergeLinks = 4;  // pairs of neighbours

double Cosine(double angle_deg) {
  return std::cos(std::min(angle_deg, 90.0) * std::numbers::pi / 180.0);
}

class PlaneGrower {
 public:
  PlaneGrower(const PointCloud& cloud, std::span<const uint32_t> chosen, const PlaneOptions& options, base::ThreadPool& threads)
      : cloud_(cloud),
        chosen_(chosen),
        options_(options),
        threads_(threads),
        around_(FindNeighbourhoods(cloud, chosen, options.reach_m, threads)),
        label_(chosen.size(), kNone) {}

  std::vector<RoofPlane> Grow() {
    GrowAll();
    MergeCoplanar();
    for (int round = 0; round < kSettleRounds; ++round) {
      Settle();
      Refit();
    }
    DropSmall();
    return Results();
  }

 private:
  const Eigen::Vector3f& Position(uint32_t p) const { return cloud_.points[chosen_[p]].position; }
  // Cosine of the angle between a plane and a point. Beside a sharp edge the neighbours' normal is a mixture that may exclude the point's own plane;
  // the point's own normal is noisy, but not mixed. Either may agree.
  double Agreement(const FittedPlane& plane, size_t p) const {
    return std::max(plane.normal.dot(around_[p].normal.cast<double>()), plane.normal.dot(cloud_.points[chosen_[p]].normal.cast<double>()));
  }
  double AreaOf(double n_points) const { return n_points * cloud_.spacing_m * cloud_.spacing_m; }
  bool LargeEnough(double n_points) const { return n_points >= options_.min_points && AreaOf(n_points) >= options_.min_area_m2; }

  void GrowAll() {
    std::vector<uint32_t> seeds;
    for (uint32_t p = 0; p < chosen_.size(); ++p) {
      if (around_[p].roughness <= kRoughestSeed) seeds.push_back(p);
    }
    std::sort(seeds.begin(), seeds.end(), [&](uint32_t a, uint32_t b) {
      return around_[a].roughness != around_[b].roughness ? around_[a].roughness < around_[b].roughness : a < b;
    });
    // Points of planes that stayed too small must not begin another: the work would be the square of their number.
    std::vector<uint8_t> tried(chosen_.size(), 0);
    for (const uint32_t seed : seeds) {
      if (label_[seed] != kNone || tried[seed] != 0) continue;
      base::ThrowIfCancelled();
      std::vector<uint32_t> points = GrowFrom(seed);
      if (LargeEnough(static_cast<double>(points.size()))) {
        planes_.emplace_back();
      } else {
        for (const uint32_t p : points) {
          label_[p] = kNone;
          tried[p] = 1;
        }
      }
    }
    Refit();
  }

  // Labels the points that it takes with the number of the next plane.
  std::vector<uint32_t> GrowFrom(uint32_t seed) {
    const auto label = static_cast<uint32_t>(planes_.size());
    const double least_cosine = Cosine(options_.angle_deg);
    PlaneSums first;
    first.Add(Position(seed));
    for (const uint32_t near : around_[seed].Near()) first.Add(Position(near));
    FittedPlane plane = first.Fit(around_[seed].normal.cast<double>());
    PlaneSums sums;
    std::vector<uint32_t> points = {seed};
    label_[seed] = label;
    sums.Add(Position(seed));
    double fitted_n = static_cast<double>(around_[seed].n + 1);
    for (size_t i = 0; i < points.size(); ++i) {
      for (const uint32_t near : around_[points[i]].Near()) {
        if (label_[near] != kNone || std::abs(plane.Distance(Position(near))) > options_.distance_m) continue;
        if (plane.normal.dot(around_[near].normal.cast<double>()) < least_cosine) continue;
        label_[near] = label;
        points.push_back(near);
        sums.Add(Position(near));
        if (sums.n() >= kRefitGrowth * fitted_n) {
          plane = sums.Fit(plane.normal);
          fitted_n = sums.n();
        }
      }
    }
    // The plane turned while it grew: what it left behind is free again.
    plane = sums.Fit(plane.normal);
    std::erase_if(points, [&](uint32_t p) {
      if (std::abs(plane.Distance(Position(p))) <= options_.distance_m) return false;
      label_[p] = kNone;
      return true;
    });
    return points;
  }

  void Refit() {
    std::vector<PlaneSums> sums(planes_.size());
    std::vector<Eigen::Vector3d> out(planes_.size(), Eigen::Vector3d::Zero());
    for (uint32_t p = 0; p < chosen_.size(); ++p) {
      if (label_[p] == kNone) continue;
      sums[label_[p]].Add(Position(p));
      out[label_[p]] += around_[p].normal.cast<double>();
    }
    for (size_t i = 0; i < planes_.size(); ++i) {
      if (sums[i].n() > 0.0) planes_[i] = sums[i].Fit(out[i]);
    }
    sums_ = std::move(sums);
  }

  // A roof that errors of the surface bend falls into several planes, which are one again within the tolerance.
  void MergeCoplanar() {
    std::map<std::pair<uint32_t, uint32_t>, int> links;
    for (uint32_t p = 0; p < chosen_.size(); ++p) {
      for (const uint32_t near : around_[p].Near()) {
        if (label_[p] != kNone && label_[near] != kNone && label_[p] < label_[near]) ++links[{label_[p], label_[near]}];
      }
    }
    std::vector<uint32_t> into(planes_.size());
    std::iota(into.begin(), into.end(), 0U);
    const auto root = [&](uint32_t i) {
      while (into[i] != i) i = into[i];
      return i;
    };
    for (const auto& [pair, count] : links) {
      uint32_t a = root(pair.first), b = root(pair.second);
      if (a == b || count < kLeastMergeLinks) continue;
      if (a > b) std::swap(a, b);
      if (planes_[a].normal.dot(planes_[b].normal) < Cosine(kMergeAngle_deg)) continue;
      PlaneSums both = sums_[a];
      both.Add(sums_[b]);
      const FittedPlane plane = both.Fit(planes_[a].normal);
      const auto offset = [&](const FittedPlane& of) { return std::abs(plane.normal.dot(of.middle - plane.middle)); };
      if (plane.rms_m > 0.5 * options_.distance_m || std::max(offset(planes_[a]), offset(planes_[b])) > 0.5 * options_.distance_m) continue;
      into[b] = a;
      sums_[a] = both;
      planes_[a] = plane;
    }
    for (uint32_t& label : label_) {
      if (label != kNone) label = root(label);
    }
    Refit();
  }

  // Each point goes to the closest plane among its own and its neighbours'.
  void Settle() {
    const double least_cosine = Cosine(options_.angle_deg + kLooserAngle_deg);
    std::vector<uint32_t> settled(label_);
    constexpr size_t kTaskPoints = 16384;
    threads_.ParallelFor(static_cast<int64_t>((label_.size() + kTaskPoints - 1) / kTaskPoints), [&](int64_t task, int) {
      const size_t begin = static_cast<size_t>(task) * kTaskPoints;
      for (size_t p = begin; p < std::min(label_.size(), begin + kTaskPoints); ++p) {
        double least = options_.distance_m;
        uint32_t best = kNone;
        const auto consider = [&](uint32_t label) {
          if (label == kNone || label == best || Agreement(planes_[label], p) < least_cosine) return;
          const double distance = std::abs(planes_[label].Distance(Position(static_cast<uint32_t>(p))));
          if (distance < least) {
            least = distance;
            best = label;
          }
        };
        consider(label_[p]);
        for (const uint32_t near : around_[p].Near()) consider(label_[near]);
        settled[p] = best;
      }
    });
    label_ = std::move(settled);
  }

  void DropSmall() {
    for (uint32_t& label : label_) {
      if (label != kNone && !LargeEnough(sums_[label].n())) label = kNone;
    }
  }

  std::vector<RoofPlane> Results() const {
    std::vector<RoofPlane> result(planes_.size());
    for (uint32_t p = 0; p < chosen_.size(); ++p) {
      if (label_[p] != kNone) result[label_[p]].points.push_back(chosen_[p]);
    }
    for (size_t i = 0; i < result.size(); ++i) {
      result[i].middle = cloud_.middle + planes_[i].middle;
      result[i].normal = planes_[i].normal;
      result[i].rms_m = planes_[i].rms_m;
      result[i].area_m2 = AreaOf(static_cast<double>(result[i].points.size()));
      std::sort(result[i].points.begin(), result[i].points.end());
    }
    std::erase_if(result, [](const RoofPlane& plane) { return plane.points.empty(); });
    std::sort(result.begin(), result.end(), [](const RoofPlane& a, const RoofPlane& b) {
      return a.points.size() != b.points.size() ? a.points.size() > b.points.size() : a.points.front() < b.points.front();
    });
    return result;
  }

  const PointCloud& cloud_;
  std::span<const uint32_t> chosen_;
  const PlaneOptions& options_;
  base::ThreadPool& threads_;
  std::vector<Neighbourhood> around_;
  std::vector<uint32_t> label_;  // of each chosen point: its plane
  std::vector<FittedPlane> planes_;
  std::vector<PlaneSums> sums_;
};

}  // namespace

std::vector<RoofPlane> GrowPlanes(const PointCloud& cloud, std::span<const uint32_t> chosen, const PlaneOptions& options, base::ThreadPool& threads) {
  SKYQUILT_CHECK(options.distance_m > 0.0 && options.reach_m > 0.0 && options.angle_deg > 0.0, "distance " + std::to_string(options.distance_m) +
                                                                                                   ", reach " + std::to_string(options.reach_m) +
                                                                                                   ", angle " + std::to_string(options.angle_deg));
  return PlaneGrower(cloud, chosen, options, threads).Grow();
}

}  // namespace skyquilt::buildings
