#include "prepare/poses/seed/ground_check.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "core/base/order_statistics.h"
#include "prepare/poses/seed/verdict.h"

namespace skyquilt::prepare::poses {
namespace {

using Complex = std::complex<double>;

// Rays flatter than about 20 degrees say little about the ground.
constexpr double kLeastDescent = 0.35;
// Positions off by 3 m 30 m above ground and directions off by 5 degrees give 0.2; directions turned by a right angle 0.4 and more.
constexpr double kMaxOffset = 0.3;
// Without their mean, differences come from relief (0.05 for a fifth of the height), tilt and turn: 15 degrees of turn give 0.08.
constexpr double kMaxSpread = 0.1;
constexpr double kMaxSpreadOfMatch = 0.2;
constexpr size_t kLeastMatches = 8;

// The horizontal part of a direction that descends by 1, east + i north, and how steep it is; steepness 0 when too flat.
struct Descent {
  Complex across;
  double steep = 0.0;
};

Descent DescentOf(const SeedView& view, const Eigen::Vector3d& ray) {
  const Eigen::Vector3d direction = view.cam_from_enu.conjugate() * ray;
  if (!(-direction.z() > kLeastDescent)) return {};
  return {Complex(direction.x(), direction.y()) / -direction.z(), -direction.z()};
}

Complex MedianOf(const std::vector<Complex>& values) {
  std::vector<double> east, north;
  for (const Complex& value : values) {
    east.push_back(value.real());
    north.push_back(value.imag());
  }
  return {base::Median(std::move(east)), base::Median(std::move(north))};
}

struct PairMotion {
  Complex shift;        // median difference of the rays of a and b
  double spread = 0.0;  // median distance from it, foreshortened as the camera sees it
  double steep = 0.0;
  Complex baseline;  // from a to b, metres
};

double WeightedMedian(std::vector<std::pair<double, double>> values) {
  std::sort(values.begin(), values.end());
  double total = 0.0, sum = 0.0;
  for (const auto& [value, weight] : values) total += weight;
  for (const auto& [value, weight] : values) {
    sum += weight;
    if (2.0 * sum >= total) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

struct Differences {
  std::vector<Complex> difference;
  std::vector<double> steep;
  std::vector<size_t> match;
};

Differences DifferencesOf(const PairRays& pair, const std::vector<SeedView>& views) {
  Differences result;
  for (size_t k = 0; k < pair.ray_a.size(); ++k) {
    const Descent a = DescentOf(views[pair.a], pair.ray_a[k]), b = DescentOf(views[pair.b], pair.ray_b[k]);
    if (a.steep == 0.0 || b.steep == 0.0) continue;
    result.difference.push_back(a.across - b.across);
    result.steep.push_back(std::min(a.steep, b.steep));
    result.match.push_back(k);
  }
  return result;
}

}  // namespace

std::vector<char> FindChancePairs(const std::vector<PairRays>& pairs, size_t n_views) {
  std::vector<size_t> most(n_views, 0);
  for (const PairRays& pair : pairs) {
    most[pair.a] = std::max(most[pair.a], pair.n_matches);
    most[pair.b] = std::max(most[pair.b], pair.n_matches);
  }
  std::vector<char> chance;
  chance.reserve(pairs.size());
  for (const PairRays& pair : pairs) {
    const auto few = kStrangersShare * static_cast<double>(std::min(most[pair.a], most[pair.b]));
    chance.push_back(pair.n_matches < kStrangersMatches && static_cast<double>(pair.n_matches) < few ? 1 : 0);
  }
  return chance;
}

GroundCheck CheckGround(const std::vector<PairRays>& pairs, const std::vector<SeedView>& views) {
  std::vector<PairMotion> motions;
  const std::vector<char> chance = FindChancePairs(pairs, views.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    const PairRays& pair = pairs[i];
    if (chance[i] != 0) continue;
    if (!views[pair.a].known || !views[pair.b].known) continue;
    const Differences rays = DifferencesOf(pair, views);
    if (rays.match.size() < kLeastMatches) continue;
    PairMotion motion;
    motion.shift = MedianOf(rays.difference);
    motion.steep = base::Median(rays.steep);
    std::vector<double> distance;
    for (size_t k = 0; k < rays.match.size(); ++k) distance.push_back(std::abs(rays.difference[k] - motion.shift) * rays.steep[k] * rays.steep[k]);
    motion.spread = base::Median(std::move(distance));
    const Eigen::Vector3d baseline = views[pair.b].centre - views[pair.a].centre;
    motion.baseline = {baseline.x(), baseline.y()};
    motions.push_back(motion);
  }
  GroundCheck check;
  check.n_pairs = motions.size();
  std::vector<std::pair<double, double>> real, imaginary;
  for (const PairMotion& motion : motions) {
    const double length = std::abs(motion.baseline);
    constexpr double kLeastBaseline_m = 1.0;
    if (length < kLeastBaseline_m) continue;
    const Complex ratio = motion.shift / motion.baseline;
    real.emplace_back(ratio.real(), length);
    imaginary.emplace_back(ratio.imag(), length);
  }
  if (real.empty()) return check;
  const Complex ratio(WeightedMedian(std::move(real)), WeightedMedian(std::move(imaginary)));
  if (!(std::abs(ratio) > 1e-5)) return check;
  check.height_m = 1.0 / std::abs(ratio);
  check.turn_rad = -std::arg(ratio);
  size_t n_agreeing = 0;
  for (const PairMotion& motion : motions) {
    const double offset = std::abs(motion.shift - ratio * motion.baseline) * motion.steep * motion.steep;
    if (offset < kMaxOffset && motion.spread < kMaxSpread) ++n_agreeing;
  }
  check.share_agreeing = static_cast<double>(n_agreeing) / static_cast<double>(motions.size());
  return check;
}

std::vector<char> MovesLikeOthers(const PairRays& pair, const std::vector<SeedView>& views) {
  std::vector<char> like(pair.ray_a.size(), 1);
  if (!views[pair.a].known || !views[pair.b].known) return like;
  const Differences rays = DifferencesOf(pair, views);
  if (rays.match.size() < kLeastMatches) return like;
  const Complex middle = MedianOf(rays.difference);
  for (size_t k = 0; k < rays.match.size(); ++k) {
    if (std::abs(rays.difference[k] - middle) * rays.steep[k] * rays.steep[k] > kMaxSpreadOfMatch) like[rays.match[k]] = 0;
  }
  return like;
}

Eigen::Quaterniond Turned(const Eigen::Quaterniond& cam_from_enu, double turn_rad) {
  return (cam_from_enu * Eigen::Quaterniond(Eigen::AngleAxisd(-turn_rad, Eigen::Vector3d::UnitZ()))).normalized();
}

}  // namespace skyquilt::prepare::poses
