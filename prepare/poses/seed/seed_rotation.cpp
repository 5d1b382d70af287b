#include "prepare/poses/seed/seed_rotation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "core/base/disjoint_sets.h"
#include "core/base/order_statistics.h"
#include "core/linear/sparse.h"

namespace skyquilt::prepare::poses {
namespace {

using Complex = std::complex<double>;

double Wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

// Turns are counter-clockwise from (east, north) to (right, up in the picture).
struct PairTurn {
  uint32_t a = 0, b = 0;
  double difference = 0.0;  // turn of b minus turn of a
  size_t n = 0;             // matches behind it
};
struct AbsoluteTurn {
  uint32_t photo = 0;
  double turn = 0.0, sigma = 1.0;
};

constexpr double kSigmaOfPair = 0.035;
constexpr double kTagError_m = 4.0;
constexpr double kTiltError = 0.08;

struct PlaneFit {
  Complex turn;   // of length 1
  Complex shift;  // p_a = scale turn p_b + shift
  bool ok = false;
};

// The similarity between the two pictures, by least squares with weights that fall with the residual.
PlaneFit FitPlane(const PairRays& pair) {
  std::vector<Complex> p, q;
  for (size_t k = 0; k < pair.ray_a.size(); ++k) {
    const Eigen::Vector3d& a = pair.ray_a[k];
    const Eigen::Vector3d& b = pair.ray_b[k];
    constexpr double kLeastDepth = 0.3;
    if (a.z() < kLeastDepth || b.z() < kLeastDepth) continue;
    p.emplace_back(a.x() / a.z(), -a.y() / a.z());
    q.emplace_back(b.x() / b.z(), -b.y() / b.z());
  }
  constexpr size_t kLeastPlaces = 8;
  PlaneFit fit;
  if (p.size() < kLeastPlaces) return fit;
  std::vector<double> weight(p.size(), 1.0), residual(p.size());
  for (int round = 0; round < 8; ++round) {
    double total = 0.0, square = 0.0;
    Complex mean_p, mean_q, product;
    for (size_t k = 0; k < p.size(); ++k) {
      total += weight[k];
      mean_p += weight[k] * p[k];
      mean_q += weight[k] * q[k];
    }
    mean_p /= total;
    mean_q /= total;
    for (size_t k = 0; k < p.size(); ++k) {
      product += weight[k] * std::conj(q[k] - mean_q) * (p[k] - mean_p);
      square += weight[k] * std::norm(q[k] - mean_q);
    }
    if (!(std::abs(product) > 0.0) || !(square > 0.0)) return fit;
    const Complex map = product / square;
    fit.turn = product / std::abs(product);
    fit.shift = mean_p - map * mean_q;
    fit.ok = true;
    for (size_t k = 0; k < p.size(); ++k) residual[k] = std::abs(p[k] - map * q[k] - fit.shift);
    constexpr double kLeastScale = 0.005;
    const double scale = std::max(base::Median(residual), kLeastScale);
    for (size_t k = 0; k < p.size(); ++k) weight[k] = 1.0 / std::pow(1.0 + std::pow(residual[k] / scale, 2), 2);
  }
  return fit;
}

// Turn that most of the measurements are near: the fullest place of a circle of bins, then the weighted mean around it.
double Mode(const std::vector<AbsoluteTurn>& turns) {
  constexpr int kBins = 72;
  constexpr int kReach = 3;
  std::array<double, kBins> full{};
  const auto bin = [](double turn) {
    return (static_cast<int>(std::floor((Wrapped(turn) / (2.0 * std::numbers::pi) + 0.5) * kBins)) % kBins + kBins) % kBins;
  };
  for (const AbsoluteTurn& turn : turns) {
    for (int d = -kReach; d <= kReach; ++d) full[static_cast<size_t>((bin(turn.turn) + d + kBins) % kBins)] += 1.0 / (turn.sigma * turn.sigma);
  }
  const auto best = std::max_element(full.begin(), full.end()) - full.begin();
  const double middle = ((static_cast<double>(best) + 0.5) / kBins - 0.5) * 2.0 * std::numbers::pi;
  double sum = 0.0, total = 0.0;
  for (const AbsoluteTurn& turn : turns) {
    const double off = Wrapped(turn.turn - middle);
    if (std::abs(off) > 0.4) continue;
    sum += off / (turn.sigma * turn.sigma);
    total += 1.0 / (turn.sigma * turn.sigma);
  }
  return middle + (total > 0.0 ? sum / total : 0.0);
}

// Turns along a tree of the pairs with the most matches; each tree is turned as a whole to where the absolute measurements want it.
std::vector<double> StartAlongTrees(const std::vector<PairTurn>& pairs, const std::vector<AbsoluteTurn>& absolute, size_t n_photos,
                                    std::vector<char>* known) {
  std::vector<size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t x, size_t y) { return pairs[x].n > pairs[y].n; });
  base::DisjointSets trees(n_photos);
  std::vector<std::vector<std::pair<uint32_t, double>>> links(n_photos);
  for (const size_t k : order) {
    const PairTurn& pair = pairs[k];
    if (trees.Root(pair.a) == trees.Root(pair.b)) continue;
    trees.Join(pair.a, pair.b);
    links[pair.a].emplace_back(pair.b, pair.difference);
    links[pair.b].emplace_back(pair.a, -pair.difference);
  }
  std::vector<double> turn(n_photos, 0.0);
  std::vector<char> visited(n_photos, 0);
  std::vector<std::vector<AbsoluteTurn>> of_photo(n_photos);
  for (const AbsoluteTurn& a : absolute) of_photo[a.photo].push_back(a);
  known->assign(n_photos, 0);
  for (uint32_t start = 0; start < n_photos; ++start) {
    if (visited[start] != 0 || links[start].empty()) continue;
    std::vector<uint32_t> members = {start};
    visited[start] = 1;
    std::vector<AbsoluteTurn> of_tree;
    for (size_t m = 0; m < members.size(); ++m) {
      const uint32_t i = members[m];
      for (const AbsoluteTurn& a : of_photo[i]) of_tree.push_back({i, a.turn - turn[i], a.sigma});
      for (const auto& [j, difference] : links[i]) {
        if (visited[j] != 0) continue;
        visited[j] = 1;
        turn[j] = turn[i] + difference;
        members.push_back(j);
      }
    }
    if (of_tree.empty()) continue;
    const double whole = Mode(of_tree);
    for (const uint32_t i : members) {
      turn[i] += whole;
      (*known)[i] = 1;
    }
  }
  return turn;
}

// Gauss-Newton on all measurements with Cauchy weights.
void Average(const std::vector<PairTurn>& pairs, const std::vector<AbsoluteTurn>& absolute, const std::vector<char>& known,
             std::vector<double>* turn) {
  const int n = static_cast<int>(turn->size());
  for (int round = 0; round < 10; ++round) {
    std::vector<linear::SparseElement> elements;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) elements.push_back({i, i, 1e-6});
    const auto weight_of = [](double residual, double sigma) { return 1.0 / (sigma * sigma * (1.0 + std::pow(residual / (3.0 * sigma), 2))); };
    for (const PairTurn& pair : pairs) {
      if (known[pair.a] == 0 || known[pair.b] == 0) continue;
      const double residual = Wrapped((*turn)[pair.b] - (*turn)[pair.a] - pair.difference);
      const double weight = weight_of(residual, kSigmaOfPair);
      const int a = static_cast<int>(pair.a), b = static_cast<int>(pair.b);
      elements.push_back({a, a, weight});
      elements.push_back({b, b, weight});
      elements.push_back({std::max(a, b), std::min(a, b), -weight});
      gradient[b] += weight * residual;
      gradient[a] -= weight * residual;
    }
    for (const AbsoluteTurn& one : absolute) {
      if (known[one.photo] == 0) continue;
      const double residual = Wrapped((*turn)[one.photo] - one.turn);
      const double weight = weight_of(residual, one.sigma);
      const int i = static_cast<int>(one.photo);
      elements.push_back({i, i, weight});
      gradient[i] += weight * residual;
    }
    const linear::SparseFactors normal(n, elements);
    if (!normal.ok()) return;
    const Eigen::VectorXd step = normal.Solve(gradient);
    if (!step.allFinite()) return;
    for (Eigen::Index i = 0; i < n; ++i) (*turn)[static_cast<size_t>(i)] -= step[i];
    if (step.cwiseAbs().maxCoeff() < 1e-5) return;
  }
}

}  // namespace

Eigen::Quaterniond RotationFromAngles(double yaw_deg, double pitch_deg, double roll_deg) {
  constexpr double kRad = std::numbers::pi / 180.0;
  const double yaw = yaw_deg * kRad, pitch = pitch_deg * kRad, roll = roll_deg * kRad;
  const Eigen::Vector3d forward(std::cos(pitch) * std::sin(yaw), std::cos(pitch) * std::cos(yaw), std::sin(pitch));
  const Eigen::Vector3d level_right(std::cos(yaw), -std::sin(yaw), 0.0);
  const Eigen::Vector3d level_down = forward.cross(level_right);
  Eigen::Matrix3d cam_from_enu;
  cam_from_enu.row(0) = std::cos(roll) * level_right + std::sin(roll) * level_down;
  cam_from_enu.row(1) = -std::sin(roll) * level_right + std::cos(roll) * level_down;
  cam_from_enu.row(2) = forward;
  return Eigen::Quaterniond(cam_from_enu).normalized();
}

std::vector<std::optional<Eigen::Quaterniond>> RotationsLookingDown(const std::vector<PairRays>& pairs, const std::vector<SeedView>& views) {
  std::vector<PairTurn> differences;
  std::vector<AbsoluteTurn> absolute;
  for (const PairRays& pair : pairs) {
    if (!views[pair.a].known || !views[pair.b].known) continue;
    const PlaneFit fit = FitPlane(pair);
    if (!fit.ok) continue;
    // A point is at turn_a * p_a over the ground seen from a, and at turn_b * p_b from b: turn_a * turn = turn_b.
    differences.push_back({pair.a, pair.b, std::arg(fit.turn), pair.ray_a.size()});
    const Eigen::Vector3d baseline = views[pair.b].centre - views[pair.a].centre;
    const double length = baseline.head<2>().norm(), shift = std::abs(fit.shift);
    constexpr double kLeastBaseline_m = 1.0;
    if (length < kLeastBaseline_m || shift < kTiltError) continue;
    const double sigma = std::hypot(kTagError_m / length, kTiltError / shift);
    if (sigma > 1.0) continue;
    const double turn = std::atan2(baseline.y(), baseline.x()) - std::arg(fit.shift);
    absolute.push_back({pair.a, turn, sigma});
  }
  std::vector<char> known;
  std::vector<double> turn = StartAlongTrees(differences, absolute, views.size(), &known);
  Average(differences, absolute, known, &turn);
  std::vector<std::optional<Eigen::Quaterniond>> rotations(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    if (known[i] != 0) rotations[i] = RotationFromAngles(-turn[i] * 180.0 / std::numbers::pi, -90.0, 0.0);
  }
  return rotations;
}

}  // namespace skyquilt::prepare::poses
