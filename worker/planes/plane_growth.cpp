#include "worker/planes/plane_growth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/base/order_statistics.h"
#include "core/linear/linear.h"
#include "worker/planes/nearest_points.h"

namespace skyquilt::worker {
namespace {

using Eigen::Vector3d;

constexpr size_t kNear = 16;  // a point and its neighbours
// Share of the variance of a neighbourhood that is across it; more is vegetation.
constexpr double kThickest = 0.04;
// The second of the three variances of a neighbourhood over the first, and over the last: less says nothing about the normal, as points on an edge.
constexpr double kOverThickness = 4.0, kOverLength = 0.02;
// The same of a whole region: five times as wide as thick, so that the fewest points know the normal to 3 degrees.
constexpr double kRegionOverThickness = 25.0;
const double kAgreeing = std::cos(18.0 / 180.0 * std::numbers::pi);
constexpr double kGrowthToRefit = 1.2;  // of the number of points since the last fit
constexpr int kMostPasses = 4;
constexpr double kFirstBands = 2.0;  // width of the band in the first pass
// Points of the same surface that lie outside the band count in its roughness, or else the band alone would decide it: those up to kNoiseBands times
// as far, of which at least kSurrounded of the neighbours are in the region. Points beyond the region's edge are not.
constexpr double kNoiseBands = 3.0, kSurrounded = 0.25;
// Share of the neighbours of a region's points, all taken together, that lie in its band. In a rough surface a few points are in a plane by chance.
constexpr double kFewestInBand = 0.5;
// Points this far from a plane show that the surface is elsewhere; still farther ones may be of another surface above or below it.
constexpr double kElsewhereBands = 10.0;

// Sums over points near an origin, from which a plane is fitted at any time.
class Moments {
 public:
  explicit Moments(const Vector3d& origin) : origin_(origin) {}
  void Add(const Vector3d& x) {
    const Vector3d d = x - origin_;
    n_ += 1.0;
    sum_ += d;
    products_ += d * d.transpose();
  }
  double n() const { return n_; }
  struct Fit {
    Plane plane;
    Vector3d variance;  // ascending
  };
  Fit Solve() const {
    const Vector3d mean = sum_ / n_;
    const linear::EigenPairs<3> eigen = linear::SymmetricEigen<3>(products_ / n_ - mean * mean.transpose());
    return {{origin_ + mean, eigen.vectors.col(0)}, eigen.values};
  }

 private:
  Vector3d origin_, sum_ = Vector3d::Zero();
  double n_ = 0.0;
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();
};

struct Surroundings {
  std::array<int32_t, kNear> near;
  Vector3d normal;
  double thickness = 0.0;  // share of the variance; infinite where the neighbourhood has no plane
  double spacing = 0.0;
};

Surroundings SurroundingsOf(const std::vector<Vector3d>& points, const NearestPoints& tree, const Vector3d& x) {
  Surroundings result;
  tree.Find(x, result.near);
  Moments moments(x);
  for (const int32_t i : result.near) moments.Add(points[static_cast<size_t>(i)]);
  const Moments::Fit fit = moments.Solve();
  const Vector3d& v = fit.variance;
  const bool flat = v[1] > kOverThickness * v[0] && v[1] > kOverLength * v[2] && v[0] <= kThickest * v.sum();
  result.normal = fit.plane.normal;
  result.thickness = flat ? v[0] / v.sum() : std::numeric_limits<double>::infinity();
  // A circle around the point out to the farthest holds kNear squares of the spacing. Points that were matched twice do not shrink it.
  result.spacing = (points[static_cast<size_t>(result.near.back())] - x).norm() * std::sqrt(std::numbers::pi / static_cast<double>(kNear));
  return result;
}

class RegionGrowth {
 public:
  RegionGrowth(const std::vector<Vector3d>& points, double gsd_m)
      : points_(points), gsd_m_(gsd_m), tried_(points.size(), false), taken_(points.size(), false), member_of_(points.size(), 0) {
    const NearestPoints tree(points);
    around_.reserve(points.size());
    for (const Vector3d& x : points) around_.push_back(SurroundingsOf(points, tree, x));
  }

  std::vector<PlaneRegion> Run() {
    std::vector<int32_t> seeds;
    for (size_t i = 0; i < points_.size(); ++i)
      if (std::isfinite(around_[i].thickness)) seeds.push_back(static_cast<int32_t>(i));
    std::stable_sort(seeds.begin(), seeds.end(), [this](int32_t a, int32_t b) { return Around(a).thickness < Around(b).thickness; });
    std::vector<PlaneRegion> regions;
    for (const int32_t seed : seeds) {
      const auto i = static_cast<size_t>(seed);
      if (tried_[i] || taken_[i]) continue;
      tried_[i] = true;
      if (std::optional<PlaneRegion> region = RegionOf(seed)) regions.push_back(std::move(*region));
    }
    return regions;
  }

 private:
  const Vector3d& At(int32_t i) const { return points_[static_cast<size_t>(i)]; }
  const Surroundings& Around(int32_t i) const { return around_[static_cast<size_t>(i)]; }
  bool IsMember(int32_t i) const { return member_of_[static_cast<size_t>(i)] == growth_; }

  // Whether a point that no region has may belong to the plane, by everything but its distance.
  bool MayJoin(int32_t i, int32_t seed, const Plane& plane) const {
    const Surroundings& around = Around(i);
    const double radius = kPlaneRadius_gsd * gsd_m_;
    return !taken_[static_cast<size_t>(i)] && std::isfinite(around.thickness) && std::abs(around.normal.dot(plane.normal)) >= kAgreeing &&
           (At(i) - At(seed)).squaredNorm() <= radius * radius;
  }
  double Distance(int32_t i, const Plane& plane) const { return std::abs(plane.normal.dot(At(i) - plane.point)); }

  // Members from the seed outwards, marked with the growth's number.
  std::vector<int32_t> Flood(int32_t seed, double bands, Moments::Fit& fit) {
    ++growth_;
    Moments moments(At(seed));
    std::vector<int32_t> members = {seed};
    member_of_[static_cast<size_t>(seed)] = growth_;
    moments.Add(At(seed));
    double refit_at = static_cast<double>(kNear);
    for (size_t k = 0; k < members.size(); ++k) {
      for (const int32_t i : Around(members[k]).near) {
        if (IsMember(i) || !MayJoin(i, seed, fit.plane) || Distance(i, fit.plane) > bands * kPlaneBand_gsd * gsd_m_) continue;
        member_of_[static_cast<size_t>(i)] = growth_;
        members.push_back(i);
        moments.Add(At(i));
      }
      if (moments.n() < refit_at) continue;
      fit = moments.Solve();
      refit_at = kGrowthToRefit * moments.n();
    }
    if (members.size() >= kNear) fit = moments.Solve();
    return members;
  }

  double ShareInBand(const std::vector<int32_t>& members, const Plane& plane) const {
    double within = 0.0;
    for (const int32_t member : members)
      for (const int32_t i : Around(member).near) within += Distance(i, plane) <= kPlaneBand_gsd * gsd_m_ ? 1.0 : 0.0;
    return within / static_cast<double>(kNear * members.size());
  }

  struct Others {
    std::vector<int32_t> noise;      // of the region's surface: outside its band, but in its midst
    std::vector<int32_t> elsewhere;  // of other surfaces: farther from the plane, but beside the region
  };
  // Points that are neighbours of members and not members.
  Others OthersNear(const std::vector<int32_t>& members, int32_t seed, const Plane& plane) const {
    std::vector<int32_t> around;
    for (const int32_t member : members)
      for (const int32_t i : Around(member).near)
        if (!IsMember(i)) around.push_back(i);
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    Others others;
    for (const int32_t i : around) {
      const double bands = Distance(i, plane) / (kPlaneBand_gsd * gsd_m_);
      const auto& near = Around(i).near;
      const auto within = std::count_if(near.begin(), near.end(), [this](int32_t other) { return IsMember(other); });
      const bool in_midst = static_cast<double>(within) >= kSurrounded * static_cast<double>(kNear);
      if (bands <= kNoiseBands && in_midst && MayJoin(i, seed, plane)) {
        others.noise.push_back(i);
      } else if (bands > 1.0 && bands <= kElsewhereBands) {
        others.elsewhere.push_back(i);
      }
    }
    return others;
  }

  std::optional<PlaneRegion> RegionOf(int32_t seed) {
    Moments start(At(seed));
    for (const int32_t i : Around(seed).near) start.Add(At(i));
    Moments::Fit fit = start.Solve();
    // The first plane is that of a few points, so it may lean and miss points that a later one reaches: its band is wider.
    std::vector<int32_t> members = Flood(seed, kFirstBands, fit);
    for (int pass = 1; pass < kMostPasses; ++pass) {
      const size_t before = members.size();
      members = Flood(seed, 1.0, fit);
      if (members.size() == before) break;
    }
    // Others of a region that fails would fail too, at the same cost.
    for (const int32_t i : members) tried_[static_cast<size_t>(i)] = true;
    if (members.size() < static_cast<size_t>(kFewestRegionPoints) || !(fit.variance[1] > kRegionOverThickness * fit.variance[0])) return std::nullopt;
    Others others = OthersNear(members, seed, fit.plane);
    std::vector<int32_t> all = members;
    all.insert(all.end(), others.noise.begin(), others.noise.end());
    double squares = 0.0;
    for (const int32_t i : all) squares += Distance(i, fit.plane) * Distance(i, fit.plane);
    const double rms_m = std::sqrt(squares / static_cast<double>(all.size()));
    if (!(rms_m < kLargestPlaneRms_gsd * gsd_m_ && ShareInBand(members, fit.plane) >= kFewestInBand)) return std::nullopt;
    // Noise must not make a second plane above or below the first.
    for (const int32_t i : all) taken_[static_cast<size_t>(i)] = true;
    std::vector<double> spacings;
    spacings.reserve(members.size());
    for (const int32_t i : members) spacings.push_back(Around(i).spacing);
    if (fit.plane.normal.z() < 0.0) fit.plane.normal = -fit.plane.normal;
    return PlaneRegion{fit.plane, rms_m, base::UpperMedian(spacings), std::move(members), std::move(others.elsewhere)};
  }

  const std::vector<Vector3d>& points_;
  double gsd_m_;
  std::vector<Surroundings> around_;
  std::vector<bool> tried_, taken_;
  std::vector<int32_t> member_of_;
  int32_t growth_ = 0;
};

}  // namespace

std::vector<PlaneRegion> GrowPlanes(const std::vector<Vector3d>& points, double gsd_m) {
  if (points.size() < static_cast<size_t>(kFewestRegionPoints)) return {};
  return RegionGrowth(points, gsd_m).Run();
}

}  // namespace skyquilt::worker
